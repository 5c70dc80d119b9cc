#include "common/dds/endpoints.hpp"

#include <algorithm>

namespace lapis::dds {
namespace {

constexpr std::string_view kTopicPrefix = "rt/", kTypeInfix = "::dds_::", kHashKey = "typehash=";

}  // namespace

void Endpoints::add(Endpoint endpoint) {
  const std::lock_guard lock(mutex_);
  const auto known = endpoints_.find(endpoint.gid);
  if (known == endpoints_.end() && endpoints_.size() >= kMost) return;
  endpoints_[endpoint.gid] = std::move(endpoint);
  ++version_;
}

void Endpoints::remove(const Gid& gid) {
  const std::lock_guard lock(mutex_);
  version_ += endpoints_.erase(gid);
}

void Endpoints::remove_participant(const Gid& participant) {
  const std::lock_guard lock(mutex_);
  version_ += std::erase_if(endpoints_, [&](const auto& entry) {
    return std::equal(participant.begin(), participant.begin() + kGidPrefixBytes, entry.first.begin());
  });
}

std::vector<Endpoint> Endpoints::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<Endpoint> found;
  for (const auto& [gid, endpoint] : endpoints_) found.push_back(endpoint);
  return found;
}

std::uint64_t Endpoints::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

std::string ros_topic_name(const std::string& dds_name) {
  return dds_name.starts_with(kTopicPrefix) ? dds_name.substr(kTopicPrefix.size() - 1) : "";
}

std::string ros_type_name(const std::string& dds_name) {
  const std::size_t at = dds_name.find(kTypeInfix);
  const std::size_t separator = dds_name.find("::");
  if (at == std::string::npos || separator >= at || !dds_name.ends_with('_')) return "";
  const std::size_t name_at = at + kTypeInfix.size();
  const std::string kind = dds_name.substr(separator + 2, at - separator - 2);  // msg, srv or action
  return dds_name.substr(0, separator) + "/" + kind + "/" + dds_name.substr(name_at, dds_name.size() - name_at - 1);
}

std::string dds_type_name(const std::string& ros_name) {
  const std::size_t first = ros_name.find('/'), second = ros_name.find('/', first + 1);
  if (first == std::string::npos || second == std::string::npos) return "";
  return ros_name.substr(0, first) + "::" + ros_name.substr(first + 1, second - first - 1) + std::string(kTypeInfix) +
         ros_name.substr(second + 1) + "_";
}

std::string type_hash_of(const Endpoint& endpoint) {
  const std::size_t at = endpoint.user_data.find(kHashKey);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + kHashKey.size();
  return endpoint.user_data.substr(begin, endpoint.user_data.find(';', begin) - begin);
}

}  // namespace lapis::dds
