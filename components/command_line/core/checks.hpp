#pragma once

#include <string>
#include <vector>

#include "command_line/core/snapshot.hpp"

namespace lapis::command_line {

/// Something that keeps a run from working, or makes it worse.
struct Finding {
  std::string fault;    ///< name for programs: "no_depth"; README.md lists them
  std::string topic;    ///< where; empty: the domain or this machine
  std::string problem;  ///< one sentence
  std::string remedy;   ///< what to do
};

/// All that is wrong with what was seen, the gravest first.
std::vector<Finding> findings_in(const Snapshot& seen);

}  // namespace lapis::command_line
