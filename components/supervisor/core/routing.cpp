#include "supervisor/core/routing.hpp"

#include <algorithm>
#include <set>

namespace lapis::supervisor {
namespace {

std::string section_of(const std::string& key) { return key.substr(0, key.find('.')); }

std::string sections_text(const Configurations& known) {
  std::set<std::string> sections;
  for (const auto& [process, configuration] : known) {
    for (const auto& [key, value] : configuration) sections.insert(section_of(key) + ".");
  }
  std::string text;
  for (const auto& section : sections) text += (text.empty() ? "" : " ") + section;
  return text;
}

}  // namespace

std::map<std::string, Settings> route(const Configurations& known, const Settings& settings) {
  std::map<std::string, Settings> routed;
  for (const auto& setting : settings) {
    bool is_taken = false;
    for (const auto& [process, configuration] : known) {
      if (!configuration.contains(setting.key)) continue;
      routed[process].push_back(setting);
      is_taken = true;
    }
    if (is_taken) continue;
    const std::string section = section_of(setting.key);
    if (setting.key == section || !known.contains(section)) {
      throw UnknownSetting(setting.key + "=" + setting.value + ": unknown key; wanted is KEY=VALUE, KEY begins with " +
                           sections_text(known));
    }
    routed[section].push_back(setting);
  }
  return routed;
}

bool knows_sections(const Configuration& configuration, const std::vector<std::string>& sections) {
  return std::all_of(sections.begin(), sections.end(), [&](const std::string& section) {
    const auto first = configuration.lower_bound(section + ".");
    return first != configuration.end() && section_of(first->first) == section;
  });
}

}  // namespace lapis::supervisor
