#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "planner/core/methods/method.hpp"

namespace lapis::planner {

/// A sentence for people that states the terms of a choice: "frontier 12: 212 nats for 4.1 m, 51.7; next best is
/// frontier 7: 150 nats for 3.7 m, 40.5". The last number of each candidate is its utility.
/// @param asks the terms that the method judges by
std::string explain(const std::vector<Candidate>& candidates, std::size_t chosen, const Asks& asks);

}  // namespace lapis::planner
