#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"

namespace lapis::simulator::fuzz {

using Bytes = std::vector<std::uint8_t>;

/// What stands between the files of one input.
inline constexpr std::string_view kBorder = "\n~~~~\n";

/// The files of one input, in the order of `names`. What follows the last one is found under every other name.
class FuzzStore final : public AssetStore {
 public:
  FuzzStore(const std::uint8_t* data, std::size_t size, std::vector<std::string> names) : names_(std::move(names)) {
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    for (std::size_t i = 0; i <= names_.size(); ++i) {
      const std::size_t end = i == names_.size() ? rest.size() : std::min(rest.find(kBorder), rest.size());
      files_.emplace_back(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(end));
      rest.remove_prefix(std::min(end + kBorder.size(), rest.size()));
    }
  }
  std::optional<Bytes> read(const std::string& name) const override {
    const auto it = std::find(names_.begin(), names_.end(), name);
    const Bytes& file = files_[static_cast<std::size_t>(it - names_.begin())];
    if (file.empty()) return std::nullopt;
    return file;
  }
  std::vector<std::string> names() const override { return names_; }
  std::string description() const override { return "fuzz"; }

 private:
  std::vector<std::string> names_;
  std::vector<Bytes> files_;
};

/// The input that FuzzStore takes apart again.
inline Bytes join(const std::vector<Bytes>& files) {
  Bytes result;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (i > 0) result.insert(result.end(), kBorder.begin(), kBorder.end());
    result.insert(result.end(), files[i].begin(), files[i].end());
  }
  return result;
}

}  // namespace lapis::simulator::fuzz
