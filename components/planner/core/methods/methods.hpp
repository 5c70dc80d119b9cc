#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/core/methods/joint.hpp"
#include "planner/core/methods/method.hpp"
#include "planner/core/methods/tare.hpp"

namespace lapis::planner {

/// Configuration of the methods that have parameters.
struct MethodsConfig {
  JointConfig joint = {};
  TareConfig tare = {};
};

/// Names as in the configuration, without "lapis", which is a second name of one of them.
const std::vector<std::string>& method_names();
/// The method of that name, "lapis" included; null for another name.
std::shared_ptr<const Method> make_method(const std::string& name, const MethodsConfig& config = {});

}  // namespace lapis::planner
