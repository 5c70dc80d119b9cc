#include "planner/core/decision/explanation.hpp"

#include <cstdio>
#include <optional>

namespace lapis::planner {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string place_of(const Candidate& candidate) {
  std::string frontier = "frontier " + std::to_string(candidate.frontier);
  switch (candidate.kind) {
    case CandidateKind::kAlternative: return frontier + " by another path";
    case CandidateKind::kCloserLook: return "a closer look at " + frontier;
    case CandidateKind::kTracked: return "a place where slam tracked";
    case CandidateKind::kGap: return "a view of gaps";
    case CandidateKind::kRevisit: return "an old place";
    default: return frontier;
  }
}

double expected_loops(const Candidate& candidate) {
  double sum = 0.0;
  for (const ExpectedLoop& loop : candidate.loops) sum += loop.probability;
  return sum;
}

std::string worth_of(const Candidate& candidate, const Asks& asks) {
  const PathValue& value = candidate.value;
  std::string terms;
  if (asks.path_information) terms += text("%.0f nats, ", value.path_information);
  if (asks.goal_information) terms += text("%.0f nats at the goal, ", value.goal_information);
  if (asks.unknown_share) terms += text("%.0f %% unknown, ", 100.0 * value.unknown_share);
  if (asks.spectrum) terms += text("loops with %.1f old places, ", expected_loops(candidate));
  if (value.tour_place > 0) terms += text("stop %d of the tour, ", value.tour_place);
  if (!terms.empty()) terms.replace(terms.size() - 2, 2, " for ");
  return place_of(candidate) + ": " + terms + text("%.1f m, %.4g", value.cost_m, candidate.utility);
}

/// The best open candidate that does not lead to the same frontier.
std::optional<std::size_t> runner_up(const std::vector<Candidate>& candidates, std::size_t chosen) {
  std::optional<std::size_t> best;
  const std::uint32_t frontier = candidates[chosen].frontier;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool is_same = i == chosen || (frontier != 0 && candidates[i].frontier == frontier);
    if (is_same || !candidates[i].is_open()) continue;
    if (!best || candidates[i].utility > candidates[*best].utility) best = i;
  }
  return best;
}

}  // namespace

std::string explain(const std::vector<Candidate>& candidates, std::size_t chosen, const Asks& asks) {
  const auto next = runner_up(candidates, chosen);
  const std::string first = worth_of(candidates[chosen], asks);
  if (!next) return first + "; there is no other";
  const bool is_kept = candidates[*next].utility > candidates[chosen].utility;
  return first + (is_kept ? ", is kept although better is " : "; next best is ") + worth_of(candidates[*next], asks);
}

}  // namespace lapis::planner
