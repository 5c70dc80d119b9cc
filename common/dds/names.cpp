#include "common/dds/names.hpp"

#include <regex>
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
  static const std::regex pattern("([A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*)?");
  if (!std::regex_match(name_space, pattern)) {
    throw std::runtime_error("--namespace '" + name_space +
                             "': use words of letters, digits and _ with / between, such as robot1 or fleet/robot1");
  }
}

}  // namespace lapis::dds
