#include "common/parameters/parameters.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "common/parameters/parameter_value.hpp"

namespace lapis::parameters {
namespace {

using rcl_interfaces::msg::Parameter;
using rcl_interfaces::msg::ParameterDescriptor;
using rcl_interfaces::msg::ParameterValue;
using rcl_interfaces::msg::SetParametersResult;
constexpr char kSeparator = '.';

bool is_within(std::string_view name, std::uint64_t depth) {
  return depth == 0 || static_cast<std::uint64_t>(std::count(name.begin(), name.end(), kSeparator)) < depth;
}

bool is_below(std::string_view name, std::string_view prefix, std::uint64_t depth) {
  if (name == prefix) return true;
  if (name.size() <= prefix.size() || !name.starts_with(prefix) || name[prefix.size()] != kSeparator) return false;
  return is_within(name.substr(prefix.size() + 1), depth);
}

}  // namespace

Parameters::Parameters(std::string process, config::Schema schema, Changes changes)
    : process_(std::move(process)), entries_(schema.entries()), changes_(std::move(changes)) {
  std::ranges::sort(entries_, {}, &config::Entry::path);
}

const config::Entry* Parameters::find(const std::string& name) const {
  const auto it = std::ranges::lower_bound(entries_, name, {}, &config::Entry::path);
  return it != entries_.end() && it->path == name ? &*it : nullptr;
}

rcl_interfaces::msg::ListParametersResult Parameters::list(const std::vector<std::string>& prefixes,
                                                           std::uint64_t depth) const {
  rcl_interfaces::msg::ListParametersResult result;
  std::set<std::string> sections;
  for (const config::Entry& entry : entries_) {
    const auto is_asked_for = [&](const std::string& prefix) { return is_below(entry.path, prefix, depth); };
    const bool is_listed =
        prefixes.empty() ? is_within(entry.path, depth) : std::ranges::any_of(prefixes, is_asked_for);
    if (!is_listed) continue;
    result.names().push_back(entry.path);
    const auto end = entry.path.rfind(kSeparator);
    if (end != std::string::npos) sections.insert(entry.path.substr(0, end));
  }
  result.prefixes().assign(sections.begin(), sections.end());
  return result;
}

ParameterValue Parameters::value(const std::string& name) const {
  const config::Entry* entry = find(name);
  return entry == nullptr ? ParameterValue() : to_value(*entry);
}

std::string Parameters::text(const std::string& name) const {
  const config::Entry* entry = find(name);
  return entry == nullptr ? "" : config::to_text(*entry);
}

ParameterDescriptor Parameters::descriptor(const std::string& name) const {
  if (const config::Entry* entry = find(name)) return to_descriptor(*entry);
  ParameterDescriptor unknown;
  unknown.name(name);
  return unknown;
}

/// Sets one parameter, without regard to rules; returns why it does not, or nothing.
std::string Parameters::refusal_of(const Parameter& parameter) {
  const config::Entry* entry = find(parameter.name());
  if (entry == nullptr) return "there is no parameter '" + parameter.name() + "'";
  if (entry->change == config::Change::kAtStart) {
    return entry->path + " is read at start: set it in the configuration and restart " + process_;
  }
  return assign(*entry, parameter.value());
}

std::string Parameters::broken_rule() const {
  if (!changes_.rules) return "";
  for (const config::Rule& rule : changes_.rules()) {
    if (!rule.holds) return rule.text;
  }
  return "";
}

SetParametersResult Parameters::set(const std::vector<Parameter>& parameters) {
  std::vector<std::pair<const config::Entry*, ParameterValue>> former;
  std::string refusal;
  for (const Parameter& parameter : parameters) {
    if (const config::Entry* entry = find(parameter.name())) former.emplace_back(entry, to_value(*entry));
    refusal = refusal_of(parameter);
    if (!refusal.empty()) break;
  }
  if (refusal.empty()) refusal = broken_rule();
  SetParametersResult result;
  result.successful(refusal.empty());
  result.reason(refusal);
  if (refusal.empty()) {
    if (changes_.apply && !parameters.empty()) changes_.apply();
  } else {
    for (auto it = former.rbegin(); it != former.rend(); ++it) assign(*it->first, it->second);
  }
  return result;
}

}  // namespace lapis::parameters
