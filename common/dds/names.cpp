#include "common/dds/names.hpp"

#include <cctype>
#include <stdexcept>

namespace lapis::dds {

std::string in_namespace(const std::string& name, const std::string& name_space) {
  if (name_space.empty()) return name;
  return name.front() == '/' ? "/" + name_space + name : name_space + "/" + name;
}

std::string topic_dds_name(const std::string& ros_name) { return ros_name.front() == '/' ? "rt" + ros_name : ros_name; }
std::string request_dds_name(const std::string& service) { return "rq" + service + "Request"; }
std::string reply_dds_name(const std::string& service) { return "rr" + service + "Reply"; }

void check_namespace(const std::string& name_space) {
  bool starts_word = true;
  bool is_valid = true;
  for (const char c : name_space) {
    const auto letter = static_cast<unsigned char>(c);
    const bool is_word = std::isalpha(letter) != 0 || c == '_' || (!starts_word && std::isdigit(letter) != 0);
    is_valid &= is_word || (c == '/' && !starts_word);
    starts_word = c == '/';
  }
  if (!name_space.empty() && (!is_valid || starts_word)) {
    throw std::runtime_error("--namespace '" + name_space +
                             "': use words of letters, digits and _ with / between, such as robot1 or fleet/robot1");
  }
}

}  // namespace lapis::dds
