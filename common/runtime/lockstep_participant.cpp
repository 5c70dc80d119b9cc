#include "common/runtime/lockstep_participant.hpp"

#include <algorithm>
#include <ctime>

#include "common/runtime/context.hpp"
#include "common/topics/lockstep.hpp"

namespace lapis::runtime {
namespace {

using lapis_msgs::msg::Ack;

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Endpoints>
auto find_topic(const Endpoints& endpoints, const std::string& dds_name) {
  return std::find_if(endpoints.begin(), endpoints.end(),
                      [&](const auto& endpoint) { return endpoint->dds_name() == dds_name; });
}

}  // namespace

LockstepParticipant::LockstepParticipant(Context& context)
    : context_(context), ack_(context.participant(), topics::kAck),
      ticks_(context.participant(), topics::kTick, [this](Tick& tick) { on_tick(tick); }) {
  context.executor().add(ticks_);
  context.every(1.0, [this] { say_busy(); });
}

void LockstepParticipant::after_handlers() {
  if (pending_ && !is_active()) pending_.reset();  // the driver has left, so nobody waits for the answer
  if (pending_) {
    answer_pending();
  } else if (is_free()) {
    context_.run_cycle({});
  }
}

bool LockstepParticipant::is_active() const { return run_ != dds::Gid{} && ticks_.is_matched(run_); }

// A newcomer to a run does not work on its inputs until a tick is due for it, or until it has seen a whole tick that
// was not due for it. The process that drives is always free.
bool LockstepParticipant::is_free() const {
  const bool drives = ticks_.is_participant_matched(context_.participant().gid());
  return !is_active() && (ticks_.matched() == 0 || drives || (is_bystander_ && ticks_.is_matched(watched_)));
}

void LockstepParticipant::on_tick(const Tick& tick) {
  const auto& due = tick.due();
  const bool is_due = std::find(due.begin(), due.end(), context_.name()) != due.end();
  if (tick.run_gid() != watched_) {
    watched_ = tick.run_gid();
    first_watched_ = tick.tick();
  }
  is_bystander_ = !is_due && (tick.tick() == 0 || tick.tick() > first_watched_ + 1);  // tick 0 names every participant
  if (!is_due) return leave_if_demoted(tick);
  last_due_ = tick.tick();
  const std::pair<std::uint64_t, std::uint32_t> number(tick.tick(), tick.stage());
  const bool is_new_run = tick.run_gid() != run_;
  if (is_new_run) {
    run_ = tick.run_gid();
    has_joined_ = false;
    answered_.reset();
    inputs_.clear();
  }
  // Samples that were published before this process joined never arrive, so they are not waited for. The driver
  // publishes its own samples of the current tick again when it knows this process. Tick 0 carries no data and is
  // repeated with the counts of each newcomer.
  if (is_new_run || tick.tick() == 0) inputs_.forgive(tick.counts(), context_.sources());
  if (answered_ && number == *answered_) {
    publish_ack(tick, lapis_msgs::msg::Ack_Constants::STATUS_DONE, "");  // the answer was lost
    return;
  } else if (answered_ && number < *answered_) {
    return;
  }
  pending_ = tick;
  if (!has_joined_) say_busy();
}

// The driver continued without this process while it was silent: from now on it runs freely, like a restarted process.
void LockstepParticipant::leave_if_demoted(const Tick& tick) {
  if (tick.run_gid() != run_ || tick.tick() <= last_due_ + 1) return;
  spdlog::warn("lock-step continues without this process since tick {}: it works on what comes by itself", last_due_);
  run_ = {};
  pending_.reset();
}

void LockstepParticipant::answer_pending() {
  const Tick& tick = *pending_;
  if (!obstacle(tick).empty()) return;
  has_joined_ = true;
  if (tick.tick() > 0) context_.run_cycle({.inputs_complete = true, .is_final = tick.is_final()});
  publish_ack(tick, lapis_msgs::msg::Ack_Constants::STATUS_DONE, "");
  answered_ = {tick.tick(), tick.stage()};
  pending_.reset();
}

/// The reason why a tick cannot be answered yet; empty when it can be answered.
std::string LockstepParticipant::obstacle(const Tick& tick) const {
  for (const auto& source : context_.sources()) {
    if (source->is_best_effort()) {
      return source->dds_name() + " is read BEST_EFFORT, and lock-step needs RELIABLE: see dds.sensor_qos, and start " +
             context_.name() + " again";
    }
  }
  if (!are_endpoints_matched(tick)) return "matching endpoints";
  if (!has_joined_ && tick.tick() > 0 && !is_admitted(tick)) return "waiting to be admitted to the run";
  const auto* missing = inputs_.missing(tick.counts(), context_.sources());
  if (missing != nullptr) return "waiting for sample " + std::to_string(missing->count()) + " on " + missing->topic();
  return "";
}

// The driver lists the readers of this process as soon as its samples reach them.
bool LockstepParticipant::is_admitted(const Tick& tick) const {
  return std::any_of(tick.readers().begin(), tick.readers().end(),
                     [this](const auto& reader) { return reader.gid() == ticks_.gid(); });
}

bool LockstepParticipant::are_endpoints_matched(const Tick& tick) const {
  const auto is_reader_matched = [this](const auto& reader) {
    const auto writer = find_topic(context_.writers(), reader.topic());
    return writer == context_.writers().end() || (*writer)->is_matched(reader.gid());
  };
  const auto is_writer_matched = [this](const auto& count) {
    const auto source = find_topic(context_.sources(), count.topic());
    return source == context_.sources().end() || (*source)->is_matched(count.writer_gid());
  };
  return std::all_of(tick.readers().begin(), tick.readers().end(), is_reader_matched) &&
         std::all_of(tick.counts().begin(), tick.counts().end(), is_writer_matched);
}

void LockstepParticipant::publish_ack(const Tick& tick, std::uint8_t status, const std::string& reason) {
  Ack ack;
  ack.run_gid(tick.run_gid());
  ack.tick(tick.tick());
  ack.stage(tick.stage());
  ack.participant(context_.name());
  ack.participant_gid(context_.participant().gid());
  ack.status(status);
  ack.reason(reason);
  for (const auto& writer : context_.writers()) {
    lapis_msgs::msg::TopicCount count;
    count.topic(writer->dds_name());
    count.writer_gid(writer->gid());
    count.count(writer->written());
    ack.counts().push_back(count);
  }
  for (const auto& source : context_.sources()) {
    lapis_msgs::msg::TopicEndpoint reader;
    reader.topic(source->dds_name());
    reader.gid(source->gid());
    ack.readers().push_back(reader);
  }
  lapis_msgs::msg::TopicEndpoint tick_reader;  // identifies this process even when it has no other reader
  tick_reader.topic(ticks_.dds_name());
  tick_reader.gid(ticks_.gid());
  ack.readers().push_back(tick_reader);
  const double cpu_s = process_cpu_s();
  ack.cpu_ms(static_cast<float>(1e3 * (cpu_s - cpu_s_at_answer_)));
  cpu_s_at_answer_ = cpu_s;
  ack_.publish(ack);
}

void LockstepParticipant::say_busy() {
  if (!pending_) return;
  const std::string reason = obstacle(*pending_);
  if (!reason.empty()) publish_ack(*pending_, lapis_msgs::msg::Ack_Constants::STATUS_BUSY, reason);
}

}  // namespace lapis::runtime
