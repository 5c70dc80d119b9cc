#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "supervisor/core/routing.hpp"

namespace lapis::supervisor {

/// A problem that the user who started the run has to correct: exit status 2.
struct BadSetup : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A process's configuration as its program prints it.
struct PrintedConfiguration {
  std::string text;  ///< YAML with a comment for each key
  Configuration values;
};

/// Runs `program` with these arguments and --print-config. Throws BadSetup with the program's own message when it
/// refuses the arguments, or when there is no such program.
PrintedConfiguration print_configuration(const std::filesystem::path& program, std::vector<std::string> arguments);

/// Names of the top-level sections of a YAML file. Throws BadSetup, which names the file, when it cannot be read.
std::vector<std::string> sections_of(const std::filesystem::path& file);

}  // namespace lapis::supervisor
