#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/config/schema.hpp"
#include "idl/rcl_interfaces.hpp"

namespace lapis::parameters {

/// The configuration of a process as parameters of a ROS 2 node: their names are the keys. The configuration structs
/// behind the schema hold the values, and outlive this.
class Parameters {
 public:
  struct Changes {
    /// Conditions between keys.
    std::function<config::Rules()> rules = {};
    /// Called when values have changed.
    std::function<void()> apply = {};
  };

  Parameters(std::string process, config::Schema schema, Changes changes);

  /// As rclcpp lists them: names that begin with one of the prefixes and a point, or are one; all when there is none.
  /// `depth` is the largest number of parts of a name behind its prefix; 0: any. In alphabetical order.
  rcl_interfaces::msg::ListParametersResult list(const std::vector<std::string>& prefixes, std::uint64_t depth) const;
  /// Type and value PARAMETER_NOT_SET for an unknown name.
  rcl_interfaces::msg::ParameterValue value(const std::string& name) const;
  /// The value as in a configuration file; empty for an unknown name.
  std::string text(const std::string& name) const;
  /// Of type PARAMETER_NOT_SET for an unknown name.
  rcl_interfaces::msg::ParameterDescriptor descriptor(const std::string& name) const;
  /// Sets all the parameters, or none: then the result has the reason.
  rcl_interfaces::msg::SetParametersResult set(const std::vector<rcl_interfaces::msg::Parameter>& parameters);

 private:
  const config::Entry* find(const std::string& name) const;
  std::string refusal_of(const rcl_interfaces::msg::Parameter& parameter);
  std::string broken_rule() const;

  std::string process_;
  std::vector<config::Entry> entries_;  // by path
  Changes changes_;
};

}  // namespace lapis::parameters
