#pragma once

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "supervisor/core/system.hpp"

namespace lapis::supervisor {

/// The configuration of a process as printed by its --print-config: key -> value as YAML text.
using Configuration = std::map<std::string, std::string>;
/// Configuration of each process, by name.
using Configurations = std::map<std::string, Configuration>;

/// A setting that no process of the run knows.
struct UnknownSetting : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Assigns each setting to every process that knows its key: "slam.…" to slam, "robot.…" to all processes that know the
/// robot. The order is kept; later settings win. `known` has all processes of the run. An unknown key whose section is
/// the name of a process goes to that process, which reports the problem itself. Throws UnknownSetting for any other
/// key.
std::map<std::string, Settings> route(const Configurations& known, const Settings& settings);

/// The processes that get a file with these top-level sections ("robot"): each section goes to every process that knows
/// it, and a process gets a whole file or nothing. Throws UnknownSetting when this is not possible because no process
/// knows a section, or because a process knows only some of the sections.
std::set<std::string> readers_of(const Configurations& known, const std::vector<std::string>& sections);

}  // namespace lapis::supervisor
