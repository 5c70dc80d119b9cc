#include "command_line/core/graph.hpp"

#include <algorithm>
#include <map>

namespace lapis::command_line {

std::vector<SeenTopic> topics_of(const std::vector<SeenEndpoint>& endpoints) {
  std::map<std::string, SeenTopic> topics;
  for (const SeenEndpoint& endpoint : endpoints) {
    SeenTopic& topic = topics[endpoint.topic];
    topic.name = endpoint.topic;
    if (std::ranges::find(topic.types, endpoint.type) == topic.types.end()) topic.types.push_back(endpoint.type);
    (endpoint.is_writer ? topic.writers : topic.readers).push_back(endpoint);
  }
  std::vector<SeenTopic> sorted;
  for (auto& [name, topic] : topics) {
    std::ranges::sort(topic.types);
    sorted.push_back(std::move(topic));
  }
  return sorted;
}

std::string SeenService::type() const { return request_type.substr(0, request_type.rfind("_Request")); }

std::string not_among(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  std::string text = "no " + what + " " + name + "; ";
  if (known.empty()) return text + "there is none at all (lapis doctor says more)";
  text += "there are ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "" : ", ") + known[i];
  return text;
}

}  // namespace lapis::command_line
