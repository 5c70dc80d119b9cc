#include "planner/decision_log.hpp"

#include <iomanip>
#include <stdexcept>

#include "common/files/atomic_file.hpp"

namespace lapis::planner {

DecisionLog::DecisionLog(const std::string& path, const std::vector<std::string>& compared_methods,
                         const std::vector<double>& compared_priors) {
  if (const auto problem = files::set_aside(path)) throw std::runtime_error(*problem);
  file_.open(path);
  file_ << "decision,time_s,method,candidate,kind,frontier,x_m,y_m,yaw_rad,cost_m,path_information_nats,"
           "goal_information_nats,places,loop_gain,fixed_n_change,end_sigma_without_loops_m,end_sigma_m,d_optimality,"
           "unknown_share,utility,explanation,ended_kind,ended_s,ended_cost_m,ended_promised_nats,ended_driven_nats,"
           "ended_gained_nats,ended_promised_loop_gain,ended_loop_gain,is_chosen,";
  for (const std::string& method : compared_methods) file_ << "is_chosen_by_" << method << ',';
  for (const double prior : compared_priors) file_ << "is_chosen_with_prior_" << prior << ',';
  file_ << "rejection\n";
  if (!file_.flush()) throw std::runtime_error(path + " cannot be written");
}

bool DecisionLog::write(const Decision& decision, const std::optional<DrivenPath>& ended, std::uint64_t id,
                        const std::string& method, time::Time stamp) {
  if (ended) ended_ = ended;
  for (std::size_t i = 0; i < decision.candidates.size(); ++i) {
    const Candidate& c = decision.candidates[i];
    file_ << std::setprecision(9) << id << ',' << to_string(stamp) << ',' << method << ',' << i << ','
          << name_of(c.kind) << ',' << c.frontier << ',' << c.goal.p_map.x() << ',' << c.goal.p_map.y() << ','
          << c.goal.yaw_rad << ',' << c.value.cost_m << ',';
    write_value(c, decision.known);
    file_ << c.utility << ',';
    if (decision.chosen == i) file_ << std::quoted(decision.explanation, '"', '"');
    file_ << ',';
    write_ended();
    file_ << (decision.chosen == i) << ',';
    for (const auto& chosen : decision.by_compared_methods) file_ << (chosen == i) << ',';
    for (const auto& chosen : decision.by_compared_fields) file_ << (chosen == i) << ',';
    file_ << text_of(c.rejection) << '\n';
  }
  return static_cast<bool>(file_.flush());
}

/// Columns of terms that no method asks for stay empty.
void DecisionLog::write_value(const Candidate& candidate, const Asks& known) {
  const PathValue& value = candidate.value;
  if (known.path_information) file_ << value.path_information;
  file_ << ',';
  if (known.goal_information) file_ << value.goal_information;
  file_ << ',';
  const ExpectedGain& gain = candidate.gain;
  if (known.spectrum) {
    file_ << candidate.loops.size() << ',' << value.loop_gain << ',' << gain.fixed_n_change << ','
          << gain.end_sigma_without_loops_m << ',' << gain.end_sigma_m << ',' << value.optimality << ',';
  } else {
    file_ << ",,,,,,";
  }
  if (known.unknown_share) file_ << value.unknown_share;
  file_ << ',';
}

void DecisionLog::write_ended() {
  if (ended_) {
    file_ << name_of(ended_->kind) << ',' << (ended_->end - ended_->begin).seconds() << ',' << ended_->cost_m << ','
          << ended_->promised_nats << ',' << ended_->driven_nats << ',' << ended_->gained_nats << ',';
    if (ended_->promised_loop_gain) file_ << *ended_->promised_loop_gain;
    file_ << ',';
    if (ended_->loop_gain) file_ << *ended_->loop_gain;
    file_ << ',';
  } else {
    file_ << ",,,,,,,,";
  }
  ended_.reset();
}

}  // namespace lapis::planner
