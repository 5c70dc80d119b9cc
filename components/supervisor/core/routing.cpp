#include "supervisor/core/routing.hpp"

namespace lapis::supervisor {
namespace {

std::string section_of(const std::string& key) { return key.substr(0, key.find('.')); }

bool knows(const Configuration& configuration, const std::string& section) {
  const auto first = configuration.lower_bound(section + ".");
  return first != configuration.end() && section_of(first->first) == section;
}

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

std::set<std::string> readers_of(const Configurations& known, const std::vector<std::string>& sections) {
  std::set<std::string> all;
  for (const auto& section : sections) {
    std::set<std::string> readers;
    for (const auto& [process, configuration] : known) {
      if (knows(configuration, section)) readers.insert(process);
    }
    if (readers.empty()) {
      throw UnknownSetting(section + ": no process of this run has such a section; there are " + sections_text(known));
    }
    if (section != sections.front() && readers != all) {
      throw UnknownSetting("the sections " + sections.front() + " and " + section +
                           " are not of the same processes; wanted is a file for each");
    }
    all = readers;
  }
  return all;
}

}  // namespace lapis::supervisor
