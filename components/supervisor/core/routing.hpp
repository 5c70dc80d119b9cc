#pragma once

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "supervisor/core/system.hpp"

namespace lapis::supervisor {

/// What a process can be set to, as its --print-config lists it: key -> value as YAML text.
using Configuration = std::map<std::string, std::string>;
/// By process.
using Configurations = std::map<std::string, Configuration>;

/// A setting that no process of the run knows.
struct UnknownSetting : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Each setting goes to every process that knows its key: "slam.…" to slam, "robot.…" to all that know the robot. In
/// the given order, later ones win. `known` has all processes of the run. A key of a process that is in the run and
/// does not know it goes there, too: the process itself says what is wrong with it. Throws UnknownSetting for any
/// other.
std::map<std::string, Settings> route(const Configurations& known, const Settings& settings);

/// Processes that get a file with these top-level sections ("robot"): each section goes to every process that knows it,
/// and a process takes a whole file or none. Throws UnknownSetting when that cannot be: nobody knows a section, or a
/// process knows only some of them.
std::set<std::string> readers_of(const Configurations& known, const std::vector<std::string>& sections);

}  // namespace lapis::supervisor
