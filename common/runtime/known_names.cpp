#include "common/runtime/known_names.hpp"

#include "common/topics.hpp"

namespace lapis::runtime {

std::vector<std::string> known_names() {
  std::vector<std::string> names(std::begin(topics::kFrames), std::end(topics::kFrames));
  topics::for_each([&](const auto& topic) { names.emplace_back(topic.name); });
  topics::for_each_service([&](const auto& service) { names.emplace_back(service.name); });
  return names;
}

}  // namespace lapis::runtime
