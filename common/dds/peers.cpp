#include "common/dds/peers.hpp"

#include <algorithm>
#include <utility>

namespace lapis::dds {
namespace {

/// Value of a key in user data of the form "key=value;key=value;"; empty without the key.
std::string value_of(const std::string& user_data, const std::string& key) {
  const std::string mark = ";" + key + "=";
  const std::string text = ";" + user_data;
  const auto at = text.find(mark);
  if (at == std::string::npos) return "";
  const auto begin = at + mark.size();
  return text.substr(begin, text.find(';', begin) - begin);
}

}  // namespace

Peers::Prefix Peers::prefix_of(const Gid& gid) {
  Prefix prefix;
  std::copy_n(gid.begin(), prefix.size(), prefix.begin());
  return prefix;
}

void Peers::add(const Gid& participant, const std::string& user_data) {
  const std::string run = value_of(user_data, "run");
  if (run.empty()) return;
  const std::lock_guard lock(mutex_);
  if (runs_.size() < kMostParticipants) runs_[prefix_of(participant)] = run;
  if (other_runs_.size() >= kMostRuns || run_.empty() || run == run_ ||
      std::find(other_runs_.begin(), other_runs_.end(), run) != other_runs_.end())
    return;
  other_runs_.push_back(run);
  new_runs_.push_back(run);
}

Kinship Peers::kinship(const Gid& endpoint) const {
  const std::lock_guard lock(mutex_);
  const auto it = runs_.find(prefix_of(endpoint));
  if (it == runs_.end() || run_.empty()) return Kinship::kNoRun;
  return it->second == run_ ? Kinship::kOwnRun : Kinship::kOtherRun;
}

std::string Peers::run_of(const Gid& endpoint) const {
  const std::lock_guard lock(mutex_);
  const auto it = runs_.find(prefix_of(endpoint));
  return it == runs_.end() ? "" : it->second;
}

std::vector<std::string> Peers::take_other_runs() {
  const std::lock_guard lock(mutex_);
  return std::exchange(new_runs_, {});
}

}  // namespace lapis::dds
