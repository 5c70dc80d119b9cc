#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/core/methods/method.hpp"
#include "planner/core/methods/methods.hpp"

namespace lapis::planner {

/// By what the next old place is chosen when nothing is left to explore; names as in configuration, but for "none".
const std::vector<std::string>& consolidation_names();
/// Drives through old places, the best by utility first: "nearest", "random", or "lapis", which is the method of that
/// name. Null for another name.
std::shared_ptr<const Method> make_consolidation(const std::string& name, const MethodsConfig& config = {});

}  // namespace lapis::planner
