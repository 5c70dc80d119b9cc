#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/core/methods/joint.hpp"
#include "planner/core/methods/method.hpp"
#include "planner/core/methods/tare.hpp"

namespace lapis::planner {

/// Of the methods that have something to set.
struct MethodsConfig {
  JointConfig joint = {};
  TareConfig tare = {};
};

/// Names as in configuration, without "lapis", which is another name of one of them.
const std::vector<std::string>& method_names();
/// Null for another name.
std::shared_ptr<const Method> make_method(const std::string& name, const MethodsConfig& config = {});

}  // namespace lapis::planner
