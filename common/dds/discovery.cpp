#include "common/dds/discovery.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace lapis::dds {
namespace {

constexpr std::size_t kLongestRun = 64;

int parse_domain(const std::string& text) {
  int domain = -1;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() || domain < 0 || domain > kLargestDomain) {
    throw std::runtime_error("ROS_DOMAIN_ID='" + text + "' is not a number from 0 to " +
                             std::to_string(kLargestDomain));
  }
  return domain;
}

std::vector<std::string> split_peers(const std::string& text) {
  std::vector<std::string> peers;
  std::istringstream in(text);
  for (std::string peer; std::getline(in, peer, ';');) {
    if (!peer.empty()) peers.push_back(peer);
  }
  return peers;
}

std::optional<std::uint32_t> parse_address(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

Network parse_network(const std::string& text) {
  const auto slash = text.find('/');
  const auto address = parse_address(text.substr(0, slash));
  unsigned bits = 32;
  bool is_valid = address.has_value();
  if (slash != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data() + slash + 1, end, bits);
    is_valid = is_valid && result.ec == std::errc() && result.ptr == end && bits <= 32;
  }
  if (!is_valid) {
    throw std::runtime_error("LAPIS_ALLOWED_PEERS: '" + text + "' is neither an IPv4 address nor a network");
  }
  return {*address, bits == 0 ? 0 : ~std::uint32_t{0} << (32 - bits)};
}

std::string parse_run(const std::string& text) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_';
  };
  if (text.size() > kLongestRun || !std::all_of(text.begin(), text.end(), is_allowed)) {
    throw std::runtime_error("LAPIS_RUN='" + text + "' is not an id: at most " + std::to_string(kLongestRun) +
                             " letters, digits, dots, dashes and underscores");
  }
  return text;
}

DiscoveryRange parse_range(const std::string& text) {
  if (text.empty() || text == "SUBNET" || text == "SYSTEM_DEFAULT") return DiscoveryRange::kSubnet;
  if (text == "OFF") return DiscoveryRange::kOff;
  return DiscoveryRange::kLocalhost;
}

}  // namespace

std::optional<std::string> process_environment(const std::string& name) {
  const char* value = std::getenv(name.c_str());  // NOLINT(concurrency-mt-unsafe): read before threads start
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

DiscoverySettings discovery_from_environment(const Environment& environment) {
  DiscoverySettings settings;
  const std::string domain = environment("ROS_DOMAIN_ID").value_or("");
  if (!domain.empty()) settings.domain = parse_domain(domain);
  settings.run = parse_run(environment("LAPIS_RUN").value_or(""));
  for (const auto& peer : split_peers(environment("LAPIS_ALLOWED_PEERS").value_or(""))) {
    settings.allowed_peers.push_back(parse_network(peer));
  }
  settings.has_server = !environment("ROS_DISCOVERY_SERVER").value_or("").empty();
  if (environment("ROS_LOCALHOST_ONLY").value_or("0") == "1") {
    settings.range = DiscoveryRange::kLocalhost;
    return settings;
  }
  settings.range = parse_range(environment("ROS_AUTOMATIC_DISCOVERY_RANGE").value_or(""));
  settings.static_peers = split_peers(environment("ROS_STATIC_PEERS").value_or(""));
  return settings;
}

std::optional<std::vector<Network>> allowed_senders(const DiscoverySettings& settings) {
  const bool meets_strangers = settings.range == DiscoveryRange::kSubnet || settings.has_server;
  if (meets_strangers && settings.allowed_peers.empty()) return std::nullopt;
  std::vector<Network> senders = settings.allowed_peers;
  for (const auto& peer : settings.static_peers) {
    if (const auto address = parse_address(peer)) senders.push_back({*address});
  }
  return senders;
}

}  // namespace lapis::dds
