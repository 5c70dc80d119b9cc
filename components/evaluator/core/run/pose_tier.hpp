#pragma once

#include <cstdint>

namespace lapis::evaluator {

/// The source of slam's pose of a frame, from best to worst; kNone: there was no pose.
enum class PoseTier : std::uint8_t { kVision, kSurfaces, kOdometry, kNone };
inline constexpr int kPoseTiers = 4;

/// The name in files: vision, surfaces, odometry or none.
constexpr const char* name_of(PoseTier tier) {
  switch (tier) {
    case PoseTier::kVision: return "vision";
    case PoseTier::kSurfaces: return "surfaces";
    case PoseTier::kOdometry: return "odometry";
    case PoseTier::kNone: break;
  }
  return "none";
}

}  // namespace lapis::evaluator
