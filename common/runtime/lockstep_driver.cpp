#include "common/runtime/lockstep_driver.hpp"

#include <algorithm>

#include "common/messages/time.hpp"
#include "common/topics/lockstep.hpp"

namespace lapis::runtime {
namespace {

using lapis_msgs::msg::Ack_Constants::STATUS_BUSY;
using lapis_msgs::msg::Ack_Constants::STATUS_DONE;
using lapis_msgs::msg::Ack_Constants::STATUS_ERROR;

constexpr double kJoinRepeat_s = 0.1;    // tick 0 waits for participants that start later, so it is repeated often
constexpr double kTickRepeat_s = 0.5;    // later ticks are repeated for a participant that has been restarted
constexpr double kLongestWait_s = 60.0;  // longest silence under the policy "wait"

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}

std::pair<std::uint64_t, std::uint32_t> number_of(const lapis_msgs::msg::Ack& ack) { return {ack.tick(), ack.stage()}; }

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

}  // namespace

LockstepDriver::LockstepDriver(Context& context, const LockstepConfig& config, std::function<void()> republish)
    : context_(context), config_(config), republish_(std::move(republish)),
      acks_(context.participant(), topics::kAck, [this](Ack& ack) { on_ack(ack); }) {
  if (context.participant().sensor_qos() == dds::SensorQos::kBestEffort) {
    throw std::runtime_error("dds.sensor_qos: best_effort loses samples, and lock-step counts them: use auto");
  }
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
  newcomers_.clear();
  outputs_.clear();
  cpu_ms_.clear();
  longest_tick_s_ = 0.0;
  number_ = 0;
  stage_ = 0;
  is_final_ = false;
  tick_began_ = Clock::now();
  publish_tick();
}

void LockstepDriver::begin(time::Time stamp, bool is_final) {
  ++number_;
  stage_ = 0;
  stamp_ = stamp;
  is_final_ = is_final;
  state_ = State::kWaiting;
  tick_began_ = stage_began_ = frame_published_ = Clock::now();
  publish_tick();
  advance();  // without stages there is nothing to wait for
}

void LockstepDriver::release_stage() {
  stage_began_ = Clock::now();
  if (stage_ < config_.stages.size()) publish_tick();
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
  if (number_of(ack) > std::make_pair(number_, stage_)) return;  // this stage was never released
  const auto known = last_ack_.find(participant);
  const bool is_new = known == last_ack_.end() || known->second.participant_gid() != ack.participant_gid();
  if (!is_new && number_of(ack) < number_of(known->second)) return;
  cpu_ms_[participant] += static_cast<double>(ack.cpu_ms());
  if (ack.status() == STATUS_ERROR) return fail(participant + " reported an error in lock-step: " + ack.reason());
  const bool is_joining = state_ == State::kJoining;
  const bool is_newcomer = is_new && ack.status() == STATUS_BUSY;
  // Samples that it published before its endpoints were matched never arrive, so they are not waited for. All later
  // samples are waited for, however long it stalls.
  if (is_joining || is_newcomer) outputs_.forgive(ack.counts(), context_.sources());
  if (is_newcomer && !is_joining) {
    newcomers_[participant] = ack;
    return admit_newcomers();
  }
  newcomers_.erase(participant);
  last_ack_[participant] = ack;
  if (is_new && is_joining) {
    // All participants must match the newcomer's endpoints, so all are asked again: the newcomer never gets a VOLATILE
    // sample that was published before.
    ++stage_;
    publish_tick();
  }
  advance();
}

bool LockstepDriver::has_answered(const std::string& participant) const {
  const auto it = last_ack_.find(participant);
  return it != last_ack_.end() && it->second.tick() == number_ && it->second.stage() == stage_ &&
         it->second.status() == STATUS_DONE;
}

/// True in a tick whose last stage has answered; samples that the answers counted may still be in transit.
bool LockstepDriver::have_all_answered() const { return state_ == State::kWaiting && stage_ >= config_.stages.size(); }

/// True when all samples that this process writes reach the participant.
bool LockstepDriver::is_matched(const Ack& ack) const {
  for (const auto& reader : ack.readers()) {
    for (const auto& writer : context_.writers()) {
      if (writer->dds_name() == reader.topic() && !writer->is_matched(reader.gid())) return false;
    }
  }
  return true;
}

bool LockstepDriver::is_everybody_matched() const {
  return std::all_of(last_ack_.begin(), last_ack_.end(),
                     [this](const auto& entry) { return is_matched(entry.second); });
}

bool LockstepDriver::are_outputs_received() const {
  return std::all_of(last_ack_.begin(), last_ack_.end(),
                     [this](const auto& entry) { return missing_output(entry.second) == nullptr; });
}

void LockstepDriver::advance() {
  if (state_ == State::kJoining) {
    if (silent().empty() && is_everybody_matched() && are_outputs_received()) {
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
    ++stage_;
    release_stage();
  }
}

/// The participants that the run waits for: for an answer, or for samples that an answer has counted.
std::vector<std::string> LockstepDriver::silent() const {
  std::vector<std::string> names;
  if (state_ == State::kWaiting && stage_ < config_.stages.size()) return {config_.stages[stage_]};
  for (const auto& name : config_.stages) {
    const auto ack = last_ack_.find(name);
    const bool is_silent = state_ == State::kJoining ? !has_answered(name)
                                                     : ack != last_ack_.end() && missing_output(ack->second) != nullptr;
    if (is_silent) names.push_back(name);
  }
  return names;
}

const lapis_msgs::msg::TopicCount* LockstepDriver::missing_output(const Ack& ack) const {
  return outputs_.missing(ack.counts(), context_.sources());
}

// The endpoints of a participant that has left must not be waited for. Discovery drops it when its lease expires.
void LockstepDriver::forget_the_dead() {
  const auto is_dead = [this](const auto& entry) {
    return !acks_.is_participant_matched(entry.second.participant_gid());
  };
  std::erase_if(last_ack_, is_dead);
  std::erase_if(newcomers_, is_dead);
}

// A participant that joins in the middle of a run has not received this tick's samples, so they are published again as
// soon as they can reach it.
void LockstepDriver::admit_newcomers() {
  const auto admitted = std::erase_if(newcomers_, [this](const auto& entry) {
    if (!is_matched(entry.second)) return false;
    spdlog::info("lock-step: {} came in tick {}; publishing it again", entry.first, number_);
    last_ack_[entry.first] = entry.second;
    return true;
  });
  if (admitted > 0) publish_frame_again();
}

void LockstepDriver::publish_frame_again() {
  if (number_ > 0) republish_();
  frame_published_ = Clock::now();
  publish_tick();
}

void LockstepDriver::check_time() {
  forget_the_dead();
  admit_newcomers();
  advance();
  if (state_ == State::kIdle || state_ == State::kFailed) return;
  const bool is_joining = state_ == State::kJoining;
  const double silence_s = seconds_since(is_joining ? tick_began_ : stage_began_);
  const double patience_s =
      config_.silent_participant == "wait" ? std::max(kLongestWait_s, config_.hard_timeout_s) : config_.hard_timeout_s;
  if (silence_s > patience_s) {
    give_up(silence_s);
  } else if (have_all_answered()) {
    return;  // nothing to repeat: the counted samples are in transit
  } else if (!is_joining && std::min(silence_s, seconds_since(frame_published_)) > config_.soft_timeout_s) {
    spdlog::warn("{}; publishing it again", describe_silence(silence_s));
    publish_frame_again();
  } else if (seconds_since(tick_published_) > (is_joining ? kJoinRepeat_s : kTickRepeat_s)) {
    publish_tick();
  }
}

std::string LockstepDriver::describe_silence(double silence_s) const {
  std::vector<std::string> words;
  for (const auto& name : silent()) {
    const auto ack = last_ack_.find(name);
    if (have_all_answered()) {
      const auto* missing = missing_output(ack->second);
      words.push_back(name + " has counted " + std::to_string(missing->count()) + " on " + missing->topic());
    } else if (ack != last_ack_.end() && ack->second.status() == STATUS_BUSY) {
      words.push_back(name + " (busy: " + ack->second.reason() + ")");
    } else {
      words.push_back(name);
    }
  }
  const std::string when =
      " to tick " + std::to_string(number_) + " for " + std::to_string(static_cast<int>(silence_s)) + " s";
  if (have_all_answered()) return "lock-step: samples counted in answers" + when + " have not come: " + joined(words);
  return "lock-step: no answer of " + joined(words) + when;
}

void LockstepDriver::give_up(double silence_s) {
  const auto participants = silent();
  if (participants.empty()) {  // while joining: all have answered, but some endpoints are not matched
    return fail("lock-step: endpoints of " + joined(config_.stages) + " were not matched; is a QoS incompatible?");
  }
  const std::string reason = describe_silence(silence_s);
  if (config_.silent_participant != "demote") {
    const char* remedy = "; is it running in this DDS domain? (lockstep.stages names the participants)";
    return fail(have_all_answered() ? reason : reason + remedy);
  }
  for (const auto& name : participants) {
    demoted_.emplace(name, number_);
    last_ack_.erase(name);
    newcomers_.erase(name);
  }
  std::erase_if(config_.stages, [this](const std::string& name) { return demoted_.contains(name); });
  if (config_.stages.empty()) return fail(reason + ", and no other participant is left");
  spdlog::warn("{}; continuing without {}", reason, joined(participants));
  context_.status().set(Status::Level::kWarn, "lock-step continues without " + joined(participants));
  if (state_ == State::kWaiting) release_stage();
  advance();
}

void LockstepDriver::fail(const std::string& reason) {
  failure_ = reason;
  state_ = State::kFailed;
}

}  // namespace lapis::runtime
