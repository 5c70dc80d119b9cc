#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "supervisor/core/routing.hpp"

namespace lapis::supervisor {

/// Something that whoever started the run has to put right: status 2.
struct BadSetup : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A process's configuration as its program prints it.
struct PrintedConfiguration {
  std::string text;  ///< YAML with a comment for each key
  Configuration values;
};

/// Asks `program` with these arguments and --print-config. Throws BadSetup with what the program has to say when it
/// refuses them, or when it is not there.
PrintedConfiguration print_configuration(const std::filesystem::path& program, std::vector<std::string> arguments);

/// Names of the top-level sections of a YAML file. Throws BadSetup that names the file.
std::vector<std::string> sections_of(const std::filesystem::path& file);

}  // namespace lapis::supervisor
