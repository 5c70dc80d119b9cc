#include "semantic_mapper/core/unconnected_frames.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "common/mapping/wire/frame_codec.hpp"

namespace lapis::semantic_mapper {

void UnconnectedFrames::add(const UnconnectedFrame& frame) {
  waiting_.push_back(
      {frame.stamp, frame.keyframe_id, frame.T_keyframe_camera, frame.is_keyframe, mapping::pack(frame.frame)});
  bytes_ += waiting_.back().frame.size();
  while (bytes_ > budget_bytes_) {
    bytes_ -= waiting_.front().frame.size();
    waiting_.pop_front();
    ++let_go_;
  }
}

void UnconnectedFrames::clear() {
  waiting_.clear();
  placed_.clear();
  bytes_ = 0;
}

void UnconnectedFrames::place(std::uint64_t graph_version, std::span<const KeyframePose> poses) {
  if (waiting_.empty()) return;
  std::unordered_map<std::uint64_t, geometry::Pose> listed;
  for (const KeyframePose& pose : poses) listed.emplace(pose.id, pose.T_map_keyframe);
  std::deque<Packed> still_waiting;
  for (Packed& frame : waiting_) {
    const auto found = listed.find(frame.keyframe_id);
    if (found == listed.end()) {
      still_waiting.push_back(std::move(frame));
      continue;
    }
    bytes_ -= frame.frame.size();
    frame.T_map_keyframe = found->second;
    frame.graph_version = graph_version;
    placed_.push_back(std::move(frame));
  }
  waiting_ = std::move(still_waiting);
}

std::optional<AnchoredFrame> UnconnectedFrames::take_placed() {
  if (placed_.empty()) return std::nullopt;
  const Packed packed = std::move(placed_.front());
  placed_.pop_front();
  auto frame = mapping::unpack_frame(packed.frame);
  if (!frame) return std::nullopt;
  return AnchoredFrame{packed.stamp,
                       packed.keyframe_id,
                       packed.T_map_keyframe,
                       packed.T_keyframe_camera,
                       packed.graph_version,
                       std::move(*frame),
                       {},
                       packed.is_keyframe};
}

}  // namespace lapis::semantic_mapper
