#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"

namespace lapis::simulator {

/// Finds the files that a model file names, even where the name is right on its author's machine only.
class AssetFinder {
 public:
  struct Found {
    std::string name;  ///< in the store
    std::vector<std::uint8_t> bytes;
    bool is_guess = false;  ///< it has another name, but is the only image beside the model
  };

  /// `model` is the model file; names are relative to its folder. The store must outlive the finder.
  AssetFinder(const AssetStore& store, const std::string& model);

  /// The file of that name; failing that, one whose name differs only in upper and lower case.
  std::optional<Found> file(std::string_view written);
  /// As file(); failing that, a file of that base name beside the model; failing that, the only image beside it.
  std::optional<Found> image(std::string_view written);

 private:
  std::optional<Found> read_any_case(const std::string& name);
  std::optional<Found> only_image();
  const std::vector<std::string>& names();

  const AssetStore& store_;
  std::string folder_;                             ///< ends with '/', or is empty
  std::optional<std::vector<std::string>> names_;  ///< listed when first needed
};

}  // namespace lapis::simulator
