#include "sensor_replay/bag_recording.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr std::chrono::milliseconds kSettling(500);

std::string list_of_topics(const bags::Contents& contents) {
  std::string text;
  for (std::size_t i = 0; i < contents.channels.size(); ++i) {
    const bags::Channel& channel = contents.channels[i];
    text += fmt::format("\n  {:<45} {:<35} {:>8} messages", channel.topic, channel.type, contents.message_counts[i]);
  }
  return text;
}

}  // namespace

std::string BagRecording::describe(const SensorReplayConfig& config) {
  const bags::BagReader bag(config.dataset);
  const bags::Contents& contents = bag.contents();
  std::string text =
      fmt::format("{}: bag of rosbag2, {} messages, {:.1f} s{}\n", config.dataset, contents.message_count(),
                  1e-9 * static_cast<double>(contents.last_ns - contents.first_ns), list_of_topics(contents));
  for (const std::string& note : contents.notes) text += "note: " + note + "\n";
  return text;
}

BagRecording::BagRecording(const SensorReplayConfig& config, runtime::Context& context)
    : config_(config), context_(context), bag_(config.dataset), clock_(context.advertise(topics::kClock)) {
  for (const std::string& note : bag_.contents().notes) spdlog::warn("{}", note);
  play_all(config.labels);
  publish_latched();
  select_rest();
  read_ahead();
  if (!ahead_) throw std::runtime_error(config.dataset + ": no colour image in the part of the bag that is played");
}

/// Publishes a topic of the table if the bag has it, under the name that the table and --remap give it.
template <class Message>
const BagRecording::Played* BagRecording::play(const dds::Topic<Message>& topic, std::optional<Role> role) {
  using Support = idl::TypeSupport<Message>;
  const bags::Contents& contents = bag_.contents();
  const std::string name = context_.participant().names().full(topic.name, topic.is_global);
  for (std::size_t i = 0; i < contents.channels.size(); ++i) {
    const bags::Channel& channel = contents.channels[i];
    if (channel.topic != name || contents.message_counts[i] == 0) continue;
    if (channel.type != Support::kRosName || channel.encoding != "cdr") {
      throw std::runtime_error(fmt::format("{}: {} is of type {}, encoded as {}; needed is {}, encoded as cdr",
                                           config_.dataset, name, channel.type, channel.encoding, Support::kRosName));
    }
    dds::Qos qos = topic.qos;
    // All of it reaches late joiners, as from the several writers that there may have been.
    if (!role) qos.depth = static_cast<int>(std::min<std::uint64_t>(contents.message_counts[i], 1000));
    auto writer = std::make_unique<dds::RawPublisher>(context_.participant(), dds::topic_dds_name(name),
                                                      Support::kDdsName, Support::kHash, qos);
    played_.push_back({i, role, writer.get()});
    context_.add(std::move(writer));
    return &played_.back();
  }
  return nullptr;
}

void BagRecording::play_all(bool with_labels) {
  const bool is_compressed = context_.options().is_color_compressed;
  const bool is_depth_compressed = context_.options().is_depth_compressed;
  require(is_compressed ? play(topics::kCompressedColor, Role::kColor) : play(topics::kColor, Role::kColor),
          is_compressed ? topics::kCompressedColor.name : topics::kColor.name);
  const Played* depth =
      is_depth_compressed ? play(topics::kCompressedDepth, Role::kPart) : play(topics::kDepth, Role::kPart);
  require(depth, is_depth_compressed ? topics::kCompressedDepth.name : topics::kDepth.name);
  depth_ = depth->writer;
  require(play(topics::kColorInfo, Role::kPart), topics::kColorInfo.name);
  require(play(topics::kDepthInfo, Role::kPart), topics::kDepthInfo.name);
  if (with_labels) {
    play(topics::kLabels, Role::kPart);
    play(topics::kLabelConfidence, Role::kPart);
    play(topics::kLabelInfo, std::nullopt);
  }
  play(topics::kWheelOdometry, Role::kOther);
  play(topics::kImu, Role::kOther);
  play(topics::kGroundTruth, Role::kOther);
  if (play(topics::kStaticTransforms, std::nullopt) == nullptr) {
    spdlog::warn("{}: no /tf_static, so that nobody learns where the camera is on the robot", config_.dataset);
  }
}

void BagRecording::require(const Played* played, const char* topic) const {
  if (played != nullptr) return;
  throw std::runtime_error(fmt::format(
      "{}: no messages on {}, which is needed. Where the camera has other names, give this process and the others "
      "--remap {}:=NAME, or a profile of config/cameras. The bag has:{}",
      config_.dataset, context_.participant().names().full(topic, false), topic, list_of_topics(bag_.contents())));
}

/// Publishes what is latched, whenever it was recorded.
void BagRecording::publish_latched() {
  bags::Selection latched{.topics = std::set<std::string>{}, .from_ns = {}, .to_ns = {}};
  for (const Played& played : played_) {
    if (!played.role) latched.topics->insert(bag_.contents().channels[played.channel].topic);
  }
  bag_.select(latched);
  while (const auto message = bag_.next()) writer_of(message->channel).publish(message->data);
}

/// Selects the part of the bag that is played.
void BagRecording::select_rest() {
  const bags::Contents& contents = bag_.contents();
  bags::Selection rest{.topics = std::set<std::string>{}, .from_ns = {}, .to_ns = {}};
  rest.from_ns = contents.first_ns + time::Duration::from_seconds(config_.start_s).nanoseconds;
  rest.to_ns = contents.last_ns;
  if (config_.duration_s > 0.0) {
    rest.to_ns =
        std::min(contents.last_ns, *rest.from_ns + time::Duration::from_seconds(config_.duration_s).nanoseconds);
  }
  std::vector<std::optional<Role>> roles(contents.channels.size());
  for (const Played& played : played_) {
    roles[played.channel] = played.role;
    if (played.role) rest.topics->insert(contents.channels[played.channel].topic);
  }
  bag_.select(rest);
  frames_.emplace(bag_, std::move(roles));
  length_s_ = std::max(0.0, 1e-9 * static_cast<double>(*rest.to_ns - *rest.from_ns));
  const double all_s = 1e-9 * static_cast<double>(contents.last_ns - contents.first_ns);
  const double share = all_s > 0.0 ? std::min(1.0, length_s_ / all_s) : 1.0;
  size_ = static_cast<std::size_t>(share * static_cast<double>(contents.message_counts[played_.front().channel]));
}

dds::RawPublisher& BagRecording::writer_of(std::size_t channel) const {
  return *std::find_if(played_.begin(), played_.end(), [&](const Played& p) { return p.channel == channel; })->writer;
}

bool BagRecording::has_readers(std::size_t number) {
  if (number == 0) return true;
  if (depth_->matched() < number) {
    matched_since_.reset();
    return false;
  }
  if (!matched_since_) matched_since_ = std::chrono::steady_clock::now();
  return std::chrono::steady_clock::now() - *matched_since_ >= kSettling;
}

std::optional<time::Time> BagRecording::next_stamp() { return ahead_ ? std::optional(ahead_->stamp) : std::nullopt; }

Recording::Step BagRecording::publish_next() {
  if (!ahead_) return Step::kEnd;
  last_ = std::move(ahead_);
  stamp_ = last_->stamp;
  publish(*last_);
  read_ahead();
  context_.status().value("messages without a readable stamp", frames_->unreadable());
  return Step::kPublished;
}

/// Damaged parts of the bag are left out, and counted.
void BagRecording::read_ahead() {
  constexpr int kMostDamage = 100;
  for (int damage = 0;; ++damage) {
    try {
      ahead_ = frames_->next();
      return;
    } catch (const std::runtime_error& error) {
      if (damage == kMostDamage) throw;
      context_.status().count("damaged parts of the bag");
      spdlog::warn("left out: {}", error.what());
    }
  }
}

void BagRecording::publish_again() {
  if (last_) publish(*last_);
}

void BagRecording::publish(const BagFrames::Frame& frame) {
  for (const bags::Message& message : frame.messages) writer_of(message.channel).publish(message.data);
  rosgraph_msgs::msg::Clock now;
  now.clock(messages::to_message(frame.stamp));
  clock_.publish(now);
}

}  // namespace lapis::sensor_replay
