#include "recorder/core/topic_choice.hpp"

#include <algorithm>

namespace lapis::recorder {

bool matches(const std::string& pattern, const std::string& text) {
  std::size_t at = 0, in_pattern = 0, retry_pattern = std::string::npos, retry_at = 0;
  while (at < text.size()) {
    if (in_pattern < pattern.size() && pattern[in_pattern] == '*') {
      retry_pattern = ++in_pattern;  // the star stands for nothing, until that fails
      retry_at = at;
    } else if (in_pattern < pattern.size() && pattern[in_pattern] == text[at]) {
      ++in_pattern;
      ++at;
    } else if (retry_pattern != std::string::npos) {
      in_pattern = retry_pattern;
      at = ++retry_at;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + static_cast<std::ptrdiff_t>(in_pattern), pattern.end(),
                     [](char c) { return c == '*'; });
}

bool TopicChoice::includes(const std::string& topic) const {
  const auto is_among = [&](const std::vector<std::string>& patterns) {
    return std::any_of(patterns.begin(), patterns.end(), [&](const auto& pattern) { return matches(pattern, topic); });
  };
  return (wanted.empty() || is_among(wanted)) && !is_among(unwanted);
}

}  // namespace lapis::recorder
