#pragma once

#include <cstdint>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator::fuzz {

/// Ends the process when a scene that a loader has returned is not sound.
inline void check(const Scene& scene) {
  if (!problem_of(scene.mesh).empty() || scene.mesh.triangles.empty()) std::abort();
  if (!(bounds(scene.mesh).diagonal().norm() < 1e6F)) std::abort();
  for (const auto& triangle : scene.mesh.triangles) {
    if (triangle.part >= scene.instances.size()) std::abort();
  }
  std::set<std::uint16_t> ids;
  for (const auto& instance : scene.instances) {
    if (instance.id == 0 || !ids.insert(instance.id).second) std::abort();
  }
}

/// Loads and checks a scene; files that are refused with a reason are fine.
template <class Load>
int check_loading(Load load) {
  try {
    check(load());
  } catch (const std::runtime_error& error) {
    if (*error.what() == '\0') std::abort();
  }
  return 0;
}

}  // namespace lapis::simulator::fuzz
