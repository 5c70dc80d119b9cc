#include "common/dds/names.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace lapis::dds {
namespace {

/// Words of letters, digits and underscores, none of which begins with a digit, with / between.
bool is_path_of_words(const std::string& text) {
  bool starts_word = true;
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    const bool is_word = std::isalpha(letter) != 0 || c == '_' || (!starts_word && std::isdigit(letter) != 0);
    if (!is_word && (c != '/' || starts_word)) return false;
    starts_word = c == '/';
  }
  return !starts_word;
}

}  // namespace

std::string in_namespace(const std::string& name, const std::string& name_space) {
  if (name_space.empty()) return name;
  return name.front() == '/' ? "/" + name_space + name : name_space + "/" + name;
}

std::string topic_dds_name(const std::string& ros_name) { return ros_name.front() == '/' ? "rt" + ros_name : ros_name; }
std::string request_dds_name(const std::string& service) { return "rq" + service + "Request"; }
std::string reply_dds_name(const std::string& service) { return "rr" + service + "Reply"; }

std::string Names::full(const std::string& name, bool is_global) const {
  const auto it = remapped.find(name);
  const std::string& chosen = it == remapped.end() ? name : it->second;
  return is_global ? chosen : in_namespace(chosen, name_space);
}

std::map<std::string, std::string> parse_remaps(const std::vector<std::string>& rules,
                                                const std::vector<std::string>& known) {
  std::map<std::string, std::string> remapped;
  for (const std::string& rule : rules) {
    const auto reject = [&](const std::string& problem) {
      throw std::runtime_error("remap '" + rule + "': " + problem);
    };
    const auto middle = rule.find(":=");
    if (middle == std::string::npos) reject("write from:=to, such as /camera/color/image_raw:=/rgb/image_raw");
    const std::string from = rule.substr(0, middle), to = rule.substr(middle + 2);
    if (std::find(known.begin(), known.end(), from) == known.end()) {
      reject("no topic, service or frame of Lapis is called " + from + "; docs/topics.md lists them");
    }
    const bool is_ros_name = from.front() == '/';
    if (is_ros_name && (to.empty() || to.front() != '/' || !is_path_of_words(to.substr(1)))) {
      reject("a topic or service needs words of letters, digits and _ with / in front of each");
    }
    if (!is_ros_name && !is_path_of_words(to)) reject("a frame needs words of letters, digits and _ with / between");
    remapped[from] = to;
  }
  return remapped;
}

void check_namespace(const std::string& name_space) {
  if (!name_space.empty() && !is_path_of_words(name_space)) {
    throw std::runtime_error("--namespace '" + name_space +
                             "': use words of letters, digits and _ with / between, such as robot1 or fleet/robot1");
  }
}

}  // namespace lapis::dds
