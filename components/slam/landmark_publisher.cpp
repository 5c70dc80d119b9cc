#include "slam/landmark_publisher.hpp"

#include "common/messages/landmarks.hpp"
#include "common/messages/time.hpp"
#include "common/topics/slam.hpp"

namespace lapis::slam {
namespace {

// Published with each frame. A loop closure changes some megabytes of tiles: at 30 Hz they are out within a second.
constexpr std::size_t kBytesPerPart = std::size_t{256} << 10;

std::size_t bytes_of(const mapping::LandmarkTile& tile) {
  return mapping::landmark_tile_bytes(tile.ids.size(), tile.observers.size());
}

}  // namespace

LandmarkPublisher::LandmarkPublisher(runtime::Context& context, double period_s)
    : context_(context), tiles_(context.advertise(topics::kLandmarks)),
      state_(context.advertise(topics::kLandmarkState)), period_s_(period_s) {}

void LandmarkPublisher::begin_epoch(std::int64_t session, std::int64_t epoch, const PublishedIds& ids) {
  for (const mapping::TileIndex& index : published_) {
    mapping::LandmarkTile tile;
    tile.index = index;
    tiles_.end_key(messages::to_message(tile, epoch_));
  }
  published_.clear();
  session_ = session;
  epoch_ = epoch;
  ids_ = ids;
  landmarks_ = LandmarkTiles(LandmarkTileConfig{});
  forget_stamps();
  graph_version_ = 0;
  left_.clear();
  is_announced_ = true;
}

bool LandmarkPublisher::wants(std::uint64_t graph_version, time::Time stamp, bool is_final) const {
  const bool is_due = is_final || !version_stamp_ || (stamp - *version_stamp_).seconds() >= period_s_;
  return is_announced_ && is_due && graph_version != graph_version_;
}

void LandmarkPublisher::forget_stamps() {
  version_stamp_.reset();
  part_stamp_.reset();
}

void LandmarkPublisher::begin_version(const Map& map, std::uint64_t graph_version,
                                      const std_msgs::msg::Header& header) {
  auto tiles = landmarks_.update(map, graph_version);
  std::size_t omitted = 0;
  for (auto& tile : tiles) {
    omitted += tile.omitted;
    for (auto& id : tile.observers) id = static_cast<std::uint32_t>(ids_.of(id));
    left_.push_back(std::move(tile));
  }
  if (omitted > 0) context_.status().count("landmarks left out: their tile is full (1 MiB)", omitted);
  graph_version_ = graph_version;
  version_stamp_ = messages::from_message(header.stamp());
  header_ = header;
  is_announced_ = false;
}

void LandmarkPublisher::publish_part(time::Time stamp) {
  if (is_announced_ || stamp == part_stamp_) return;
  part_stamp_ = stamp;
  for (std::size_t bytes = 0; !left_.empty() && bytes < kBytesPerPart;) {
    bytes += bytes_of(left_.front());
    publish_next_tile();
  }
  if (left_.empty()) publish_state();
}

void LandmarkPublisher::publish_rest() {
  while (!left_.empty()) publish_next_tile();
  if (!is_announced_) publish_state();
}

void LandmarkPublisher::publish_next_tile() {
  published_.insert(left_.front().index);
  tiles_.publish(messages::to_message(left_.front(), epoch_));
  left_.pop_front();
}

void LandmarkPublisher::publish_state() {
  auto message = messages::to_message(landmarks_.state());
  message.header(header_);
  message.session(session_);
  message.epoch(epoch_);
  state_.publish(message);
  is_announced_ = true;
}

bool LandmarkPublisher::wait_until_acknowledged(double timeout_s) {
  return tiles_.wait_until_acknowledged(timeout_s) && state_.wait_until_acknowledged(timeout_s);
}

}  // namespace lapis::slam
