#include "common/runtime/lockstep_driver.hpp"

#include <algorithm>

#include "common/messages/time.hpp"

namespace lapis::runtime {
namespace {

constexpr double kJoinRepeat_s = 0.1;    // tick 0 is for those who come later, so it is repeated often
constexpr double kTickRepeat_s = 0.5;    // later ones for a participant that has been restarted
constexpr double kLongestWait_s = 60.0;  // policy "wait"

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

}  // namespace

LockstepDriver::LockstepDriver(Context& context, const LockstepConfig& config, std::function<void()> republish)
    : context_(context), config_(config), republish_(std::move(republish)),
      acks_(context.participant(), topics::kAck, [this](Ack& ack) { on_ack(ack); }) {
  context.executor().add(acks_);
  context.every(kJoinRepeat_s / 2, [this] { check_time(); });
  restart();
}

LockstepDriver::State LockstepDriver::state() {
  advance();
  return state_;
}

void LockstepDriver::restart() {
  tick_.emplace(context_.participant(), topics::kTick);
  state_ = State::kJoining;
  last_ack_.clear();
  outputs_.clear();
  number_ = 0;
  stage_ = 0;
  is_final_ = false;
  tick_began_ = Clock::now();
  release_stage();
}

void LockstepDriver::begin(time::Time stamp, bool is_final) {
  ++number_;
  stage_ = 0;
  stamp_ = stamp;
  is_final_ = is_final;
  state_ = State::kWaiting;
  tick_began_ = frame_published_ = Clock::now();
  release_stage();
  advance();  // no stages: nothing to wait for
}

void LockstepDriver::release_stage() {
  heard_.clear();
  for (const auto& participant : config_.stages) heard_[participant] = Clock::now();
  publish_tick();
}

void LockstepDriver::publish_tick() {
  lapis_msgs::msg::Tick tick;
  tick.run_gid(tick_->gid());
  tick.tick(number_);
  tick.stamp(messages::to_message(stamp_));
  tick.stage(stage_);
  tick.is_final(is_final_);
  if (state_ == State::kJoining) {
    tick.due(config_.stages);
  } else if (stage_ < config_.stages.size()) {
    tick.due({config_.stages[stage_]});
  }
  for (const auto& writer : context_.writers()) {
    lapis_msgs::msg::TopicCount count;
    count.topic(writer->dds_name());
    count.writer_gid(writer->gid());
    count.count(writer->written());
    tick.counts().push_back(count);
  }
  for (const auto& source : context_.sources()) {
    lapis_msgs::msg::TopicEndpoint reader;
    reader.topic(source->dds_name());
    reader.gid(source->gid());
    tick.readers().push_back(reader);
  }
  for (const auto& [participant, ack] : last_ack_) {
    for (const auto& count : ack.counts()) tick.counts().push_back(count);
    for (const auto& reader : ack.readers()) tick.readers().push_back(reader);
  }
  tick_->publish(tick);
  tick_published_ = Clock::now();
}

void LockstepDriver::on_ack(const Ack& ack) {
  const auto& stages = config_.stages;
  const std::string& participant = ack.participant();
  if (ack.run_gid() != tick_->gid() || std::find(stages.begin(), stages.end(), participant) == stages.end()) return;
  if (std::make_pair(ack.tick(), ack.stage()) > std::make_pair(number_, stage_)) return;  // was never released
  // BUSY is no sign of life: who waits for an input that cannot come any more would wait for ever.
  if (ack.status() == lapis_msgs::msg::Ack_Constants::STATUS_DONE) heard_[participant] = Clock::now();
  const auto known = last_ack_.find(participant);
  const bool is_old =
      known != last_ack_.end() && known->second.participant_gid() == ack.participant_gid() &&
      std::make_pair(ack.tick(), ack.stage()) < std::make_pair(known->second.tick(), known->second.stage());
  if (is_old) return;
  const bool is_new = known == last_ack_.end() || known->second.participant_gid() != ack.participant_gid();
  last_ack_[participant] = ack;
  cpu_ms_[participant] += static_cast<double>(ack.cpu_ms());
  if (is_new || state_ == State::kJoining) outputs_.forgive(ack.counts(), context_.sources());
  if (is_new && state_ == State::kJoining) {
    // All must match the newcomer's endpoints, so all are asked again; a VOLATILE sample from before is nobody's.
    ++stage_;
    publish_tick();
  }
  if (ack.status() == lapis_msgs::msg::Ack_Constants::STATUS_ERROR) {
    failure_ = participant + " reported an error in lock-step: " + ack.reason();
    state_ = State::kFailed;
    return;
  }
  advance();
}

bool LockstepDriver::has_answered(const std::string& participant) const {
  const auto it = last_ack_.find(participant);
  return it != last_ack_.end() && it->second.tick() == number_ && it->second.stage() == stage_ &&
         it->second.status() == lapis_msgs::msg::Ack_Constants::STATUS_DONE;
}

bool LockstepDriver::is_everybody_matched() const {
  for (const auto& [participant, ack] : last_ack_) {
    for (const auto& reader : ack.readers()) {
      for (const auto& writer : context_.writers()) {
        if (writer->dds_name() == reader.topic() && !writer->is_matched(reader.gid())) return false;
      }
    }
  }
  return true;
}

bool LockstepDriver::are_outputs_received() const {
  return std::all_of(last_ack_.begin(), last_ack_.end(), [this](const auto& entry) {
    return outputs_.are_received(entry.second.counts(), context_.sources());
  });
}

void LockstepDriver::advance() {
  if (state_ == State::kJoining) {
    if (silent().empty() && is_everybody_matched()) {
      state_ = State::kIdle;
      spdlog::info("lock-step: {} joined after {:.1f} s", joined(config_.stages), seconds_since(tick_began_));
    }
    return;
  }
  while (state_ == State::kWaiting) {
    if (stage_ >= config_.stages.size()) {
      if (!are_outputs_received()) return;
      longest_tick_s_ = std::max(longest_tick_s_, seconds_since(tick_began_));
      state_ = State::kIdle;
      return;
    }
    if (!has_answered(config_.stages[stage_])) return;
    if (++stage_ < config_.stages.size()) release_stage();
  }
}

std::vector<std::string> LockstepDriver::silent() const {
  std::vector<std::string> names;
  if (state_ == State::kJoining) {
    for (const auto& name : config_.stages) {
      if (!has_answered(name)) names.push_back(name);
    }
  } else if (state_ == State::kWaiting && stage_ < config_.stages.size()) {
    names.push_back(config_.stages[stage_]);
  }
  return names;
}

// The endpoints of a participant that has left must not be waited for. It drops out of discovery with its lease.
void LockstepDriver::forget_the_dead() {
  std::erase_if(last_ack_,
                [this](const auto& entry) { return !acks_.is_participant_matched(entry.second.participant_gid()); });
}

void LockstepDriver::check_time() {
  forget_the_dead();
  const double patience_s =
      config_.silent_participant == "wait" ? std::max(kLongestWait_s, config_.hard_timeout_s) : config_.hard_timeout_s;
  if (state_ == State::kJoining) {
    advance();
    if (state_ != State::kJoining) return;
    if (seconds_since(tick_published_) >= kJoinRepeat_s) publish_tick();
    if (seconds_since(tick_began_) > patience_s) give_up_on(silent(), patience_s);
    return;
  }
  if (state_ != State::kWaiting || stage_ >= config_.stages.size()) return;
  const double silence_s = seconds_since(heard_[config_.stages[stage_]]);
  if (silence_s > patience_s) {
    give_up_on(silent(), silence_s);
  } else if (silence_s > config_.soft_timeout_s && seconds_since(frame_published_) > config_.soft_timeout_s) {
    spdlog::warn("lock-step: no answer of {} to tick {} for {:.0f} s; publishing it again", config_.stages[stage_],
                 number_, silence_s);
    republish_();
    frame_published_ = Clock::now();
    publish_tick();
  } else if (seconds_since(tick_published_) > kTickRepeat_s) {
    publish_tick();
  }
}

void LockstepDriver::give_up_on(const std::vector<std::string>& participants, double silence_s) {
  if (participants.empty()) {  // while joining: all have answered, but not all endpoints are matched
    failure_ = "lock-step: readers of " + joined(config_.stages) + " were not matched; is a QoS incompatible?";
    state_ = State::kFailed;
    return;
  }
  if (config_.silent_participant == "demote") {
    spdlog::warn("lock-step: going on without {}", joined(participants));
    std::erase_if(config_.stages, [&](const std::string& name) {
      return std::find(participants.begin(), participants.end(), name) != participants.end();
    });
    for (const auto& name : participants) last_ack_.erase(name);
    if (state_ == State::kWaiting && stage_ < config_.stages.size()) release_stage();
    advance();
    return;
  }
  failure_ = "lock-step: no answer of " + joined(participants) + " to tick " + std::to_string(number_) + " for " +
             std::to_string(static_cast<int>(silence_s)) +
             " s; is it running in this DDS domain? (lockstep.stages names the participants)";
  state_ = State::kFailed;
}

}  // namespace lapis::runtime
