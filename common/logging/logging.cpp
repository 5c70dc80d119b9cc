#include "common/logging/logging.hpp"

#include <spdlog/sinks/stdout_sinks.h>

#include <map>
#include <stdexcept>

namespace lapis::logging {

void set_up(const std::string& component, const std::string& level) {
  auto logger = spdlog::get(component);
  if (logger == nullptr) logger = spdlog::stderr_logger_mt(component);
  logger->set_pattern("%H:%M:%S.%e %-5l %n: %v");
  logger->flush_on(spdlog::level::debug);
  spdlog::set_default_logger(logger);
  set_level(level);
}

void set_level(const std::string& level) {
  static const std::map<std::string, spdlog::level::level_enum> levels = {{"debug", spdlog::level::debug},
                                                                          {"info", spdlog::level::info},
                                                                          {"warn", spdlog::level::warn},
                                                                          {"error", spdlog::level::err}};
  const auto it = levels.find(level);
  if (it == levels.end()) throw std::runtime_error("log level '" + level + "': use debug, info, warn or error");
  spdlog::default_logger()->set_level(it->second);
}

}  // namespace lapis::logging
