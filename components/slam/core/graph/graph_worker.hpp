#pragma once

#include <cstdint>
#include <future>
#include <optional>

#include "slam/core/graph/slam_graph.hpp"

namespace lapis::slam {

/// Optimises a copy of the pose graph in a thread of its own. The result is due at a fixed frame, however long it took,
/// so that runs are the same on fast and on slow machines.
class GraphWorker {
 public:
  bool is_busy() const { return result_.valid(); }
  /// Begins; the result is due at frame number `due`. Not while busy.
  void start(PoseGraphSnapshot graph, std::uint64_t due);
  /// The result once it is due, waiting for it if need be.
  std::optional<GraphCorrection> take(std::uint64_t frame);

 private:
  std::future<GraphCorrection> result_;
  std::uint64_t due_ = 0;
};

}  // namespace lapis::slam
