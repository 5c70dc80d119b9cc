#pragma once

#include "common/parameters/parameters.hpp"
#include "common/runtime/context.hpp"

namespace lapis::runtime {

/// Serves what ROS 2 asks every node for: its parameters, with /parameter_events, and descriptions of message types.
/// The requests are handled on the component's thread, between its cycles.
class NodeServices {
 public:
  NodeServices(Context& context, parameters::Parameters parameters);
  NodeServices(const NodeServices&) = delete;
  NodeServices& operator=(const NodeServices&) = delete;

 private:
  using Parameter = rcl_interfaces::msg::Parameter;

  void serve_reading();
  void serve_setting();
  rcl_interfaces::msg::SetParametersResult set(const std::vector<Parameter>& wanted);

  Context& context_;
  parameters::Parameters parameters_;
  std::string node_;  // "/robot1/slam"
  dds::Publisher<rcl_interfaces::msg::ParameterEvent> events_;
};

}  // namespace lapis::runtime
