#include "planner/core/methods/consolidation.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "planner/core/candidates/old_places.hpp"

namespace lapis::planner {
namespace {

/// Draws a number from the position of the place, so that the order is random but the same for the same map.
class RandomPlace : public Method {
 public:
  Asks asks() const override { return {}; }
  double utility(const Candidate& candidate) const override {
    constexpr double kGrain_m = 0.25;
    const auto number = [](double m) { return static_cast<std::uint32_t>(std::lround(m / kGrain_m)); };
    std::seed_seq seed{number(candidate.target_map.x()), number(candidate.target_map.y())};
    return 1.0 + static_cast<double>(std::mt19937(seed)());
  }
};

/// Judges drives through old places by the utility of another method.
class AmongOldPlaces : public Method {
 public:
  explicit AmongOldPlaces(std::shared_ptr<const Method> judge) : judge_(std::move(judge)) {}
  Asks asks() const override { return judge_->asks(); }
  double utility(const Candidate& candidate) const override { return judge_->utility(candidate); }
  std::vector<Candidate> propose(const ProposalInput& in) const override { return propose_old_places(in); }
  bool has_own_candidates() const override { return true; }

 private:
  std::shared_ptr<const Method> judge_;
};

}  // namespace

const std::vector<std::string>& consolidation_names() {
  static const std::vector<std::string> names{"nearest", "random", "lapis"};
  return names;
}

std::shared_ptr<const Method> make_consolidation(const std::string& name, const MethodsConfig& config) {
  if (name == "random") return std::make_shared<AmongOldPlaces>(std::make_shared<RandomPlace>());
  if (name == "nearest" || name == "lapis") return std::make_shared<AmongOldPlaces>(make_method(name, config));
  return nullptr;
}

}  // namespace lapis::planner
