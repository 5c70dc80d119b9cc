#pragma once

#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"

namespace lapis::planner {

/// Looks at targets, judged when the map has had time to tell: a frontier that is still there after it has been looked
/// at is glass, or noise.
class Looks {
 public:
  /// The target is judged at the first call of judge() from `due` on.
  void await(const VainLook& look, time::Time due);
  /// Those now due that were in vain.
  std::vector<VainLook> judge(const Surroundings& surroundings, time::Time now);
  /// All that were in vain.
  const std::vector<VainLook>& in_vain() const { return in_vain_; }
  void forgive() { in_vain_.clear(); }
  void clear();

 private:
  struct Awaited {
    VainLook look;  ///< if it is in vain
    time::Time due;
  };
  std::vector<Awaited> awaited_;  ///< the first due first
  std::vector<VainLook> in_vain_;
};

}  // namespace lapis::planner
