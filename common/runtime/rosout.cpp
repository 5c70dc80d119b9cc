#include "common/runtime/rosout.hpp"

#include <algorithm>
#include <utility>

#include "common/topics/node.hpp"

namespace lapis::runtime {
namespace {

constexpr double kLastLinesPatience_s = 0.2;

std::uint8_t level_of(spdlog::level::level_enum level) {
  namespace levels = rcl_interfaces::msg::Log_Constants;
  switch (level) {
    case spdlog::level::warn: return levels::WARN;
    case spdlog::level::err: return levels::ERROR;
    case spdlog::level::critical: return levels::FATAL;
    case spdlog::level::info: return levels::INFO;
    default: return levels::DEBUG;
  }
}

/// Full name of a node as that of its logger: "/robot1/slam" is "robot1.slam".
std::string logger_name(std::string node) {
  if (node.starts_with('/')) node.erase(0, 1);
  std::ranges::replace(node, '/', '.');
  return node;
}

}  // namespace

rcl_interfaces::msg::Log to_message(const logging::Line& line, const std::string& name) {
  const auto since_epoch = line.stamp.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  rcl_interfaces::msg::Log message;
  message.stamp().sec(static_cast<std::int32_t>(seconds.count()));
  message.stamp().nanosec(static_cast<std::uint32_t>(std::chrono::nanoseconds(since_epoch - seconds).count()));
  message.level(level_of(line.level));
  message.name(name);
  message.msg(line.text);
  message.file(line.file);
  message.function(line.function);
  message.line(line.line);
  return message;
}

Rosout::Rosout(dds::Participant& participant, const std::string& node, std::shared_ptr<logging::LineQueue> lines)
    : lines_(std::move(lines)), name_(logger_name(node)), publisher_(participant, topics::kRosout),
      thread_([this] { publish_lines(); }) {}

Rosout::~Rosout() {
  lines_->close();
  thread_.join();
  publisher_.wait_until_acknowledged(kLastLinesPatience_s);
}

void Rosout::publish_lines() {
  for (auto lines = lines_->take(); !lines.empty(); lines = lines_->take()) {
    for (const logging::Line& line : lines) publisher_.publish(to_message(line, name_));
  }
}

}  // namespace lapis::runtime
