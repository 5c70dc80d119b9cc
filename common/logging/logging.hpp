#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace lapis::logging {

/// Sends the process's log to standard error, one line per message: time, level, component, text. `level` is one of
/// debug, info, warn, error; throws std::runtime_error for another word.
void set_up(const std::string& component, const std::string& level);
/// The lowest level of messages that are logged, as in set_up().
void set_level(const std::string& level);

}  // namespace lapis::logging
