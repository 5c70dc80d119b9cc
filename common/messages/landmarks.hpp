#pragma once

#include "common/mapping/wire/landmark_tile.hpp"
#include "common/messages/converted.hpp"
#include "idl/lapis_msgs.hpp"

namespace lapis::messages {

/// Refused when the lists have inconsistent lengths, are not in order or exceed mapping::kMaxLandmarkTileBytes, or when
/// a position is not finite.
Converted<mapping::LandmarkTile> from_message(const lapis_msgs::msg::LandmarkTile& message);
mapping::LandmarkState from_message(const lapis_msgs::msg::LandmarkState& message);

lapis_msgs::msg::LandmarkTile to_message(const mapping::LandmarkTile& tile, std::int64_t epoch);
/// The caller sets the header.
lapis_msgs::msg::LandmarkState to_message(const mapping::LandmarkState& state);

}  // namespace lapis::messages
