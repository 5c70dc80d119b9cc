#pragma once

#include <memory>
#include <string>
#include <thread>

#include "common/dds/publisher.hpp"
#include "common/logging/line_queue.hpp"
#include "idl/rcl_interfaces.hpp"

namespace lapis::runtime {

/// A line of the log as ROS 2 has it. `name` is that of the logger: "robot1.slam".
rcl_interfaces::msg::Log to_message(const logging::Line& line, const std::string& name);

/// Publishes the lines of the log on /rosout, from a thread of its own: whoever logs waits neither for DDS nor for
/// this, and a line that DDS refuses is lost there without another line about it.
class Rosout {
 public:
  Rosout(dds::Participant& participant, const std::string& node, std::shared_ptr<logging::LineQueue> lines);
  /// Publishes what is left.
  ~Rosout();
  Rosout(const Rosout&) = delete;
  Rosout& operator=(const Rosout&) = delete;

 private:
  void publish_lines();

  std::shared_ptr<logging::LineQueue> lines_;
  std::string name_;
  dds::Publisher<rcl_interfaces::msg::Log> publisher_;
  std::thread thread_;
};

}  // namespace lapis::runtime
