#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/mapping/votes/compact_frame.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"

namespace lapis::semantic_mapper {

/// A camera frame in a sub-map of slam: its key-frame is not in the pose graph, so nobody knows where in the map it is.
struct UnconnectedFrame {
  time::Time stamp;
  std::uint64_t keyframe_id = 0;
  geometry::Pose T_keyframe_camera = geometry::Pose::Identity();
  mapping::CompactFrame frame;
  bool is_keyframe = false;  ///< it is its own reference
};

/// Keeps such frames, packed, until a pose graph lists their key-frames. Beyond the budget the oldest are let go: those
/// of sub-maps that slam has given up would stay for ever.
class UnconnectedFrames {
 public:
  explicit UnconnectedFrames(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  void add(const UnconnectedFrame& frame);
  /// Takes over the poses of key-frames for which frames wait.
  void place(std::uint64_t graph_version, std::span<const KeyframePose> poses);
  /// The oldest frame whose key-frame has a pose.
  std::optional<AnchoredFrame> take_placed();

  /// Forgets all frames.
  void clear();

  std::size_t size() const { return waiting_.size() + placed_.size(); }
  /// Number of frames beyond the budget.
  std::size_t let_go() const { return let_go_; }

 private:
  struct Packed {
    time::Time stamp;
    std::uint64_t keyframe_id = 0;
    geometry::Pose T_keyframe_camera;
    bool is_keyframe = false;
    std::vector<std::uint8_t> frame;
    geometry::Pose T_map_keyframe = geometry::Pose::Identity();  // once it is placed
    std::uint64_t graph_version = 0;                             // the same
  };

  std::size_t budget_bytes_;
  std::size_t bytes_ = 0;  // of the waiting frames
  std::deque<Packed> waiting_, placed_;
  std::size_t let_go_ = 0;
};

}  // namespace lapis::semantic_mapper
