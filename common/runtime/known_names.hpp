#pragma once

#include <string>
#include <vector>

namespace lapis::runtime {

/// Names of all topics, services and frames that Lapis's processes agree on, without a namespace.
std::vector<std::string> known_names();

}  // namespace lapis::runtime
