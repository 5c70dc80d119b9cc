#pragma once

#include <string>
#include <vector>

namespace lapis::recorder {

/// Which topics are recorded.
struct TopicChoice {
  std::vector<std::string> wanted;    ///< names or patterns, in which `*` stands for any text; empty: all
  std::vector<std::string> unwanted;  ///< the same; wins over `wanted`

  bool includes(const std::string& topic) const;
};

/// Whether `text` is what the pattern says; `*` stands for any text, also for none.
bool matches(const std::string& pattern, const std::string& text);

}  // namespace lapis::recorder
