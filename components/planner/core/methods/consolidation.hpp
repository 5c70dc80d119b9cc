#pragma once

#include <memory>
#include <string>
#include <vector>

#include "planner/core/methods/method.hpp"
#include "planner/core/methods/methods.hpp"

namespace lapis::planner {

/// Names of the rules that choose the next old place when nothing is left to explore: as in the configuration, without
/// "none".
const std::vector<std::string>& consolidation_names();
/// A method that drives through old places, in the order of utility: "nearest", "random", or "lapis", which judges them
/// as the method of that name. Null for another name.
std::shared_ptr<const Method> make_consolidation(const std::string& name, const MethodsConfig& config = {});

}  // namespace lapis::planner
