#include "simulator/core/assets/asset_finder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <utility>

namespace lapis::simulator {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string with_slashes(std::string_view written) {
  std::string result(written);
  std::replace(result.begin(), result.end(), '\\', '/');
  return result;
}

std::string base_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

bool is_image(const std::string& name) {
  static constexpr std::array<std::string_view, 4> kEndings{".png", ".jpg", ".jpeg", ".bmp"};
  const std::string lowered = lower(name);
  return std::any_of(kEndings.begin(), kEndings.end(), [&](std::string_view e) { return lowered.ends_with(e); });
}

}  // namespace

AssetFinder::AssetFinder(const AssetStore& store, const std::string& model)
    : store_(store), folder_(model.substr(0, model.rfind('/') + 1)) {}

std::optional<AssetFinder::Found> AssetFinder::file(std::string_view written) {
  const std::string path = with_slashes(written);
  if (path.empty() || path.front() == '/') return std::nullopt;
  return read_any_case(std::filesystem::path(folder_ + path).lexically_normal().generic_string());
}

std::optional<AssetFinder::Found> AssetFinder::image(std::string_view written) {
  if (auto found = file(written)) return found;
  if (auto found = file(base_name(with_slashes(written)))) return found;
  return only_image();
}

std::optional<AssetFinder::Found> AssetFinder::read_any_case(const std::string& name) {
  if (auto bytes = store_.read(name)) return Found{name, std::move(*bytes), false};
  const std::string lowered = lower(name);
  for (const auto& candidate : names()) {
    if (lower(candidate) != lowered) continue;
    if (auto bytes = store_.read(candidate)) return Found{candidate, std::move(*bytes), false};
  }
  return std::nullopt;
}

std::optional<AssetFinder::Found> AssetFinder::only_image() {
  std::vector<std::string> images;
  for (const auto& name : names()) {
    const bool is_beside_model = name.starts_with(folder_) && name.find('/', folder_.size()) == std::string::npos;
    if (is_beside_model && is_image(name)) images.push_back(name);
  }
  if (images.size() != 1) return std::nullopt;
  auto bytes = store_.read(images.front());
  if (!bytes) return std::nullopt;
  return Found{images.front(), std::move(*bytes), true};
}

const std::vector<std::string>& AssetFinder::names() {
  if (!names_) names_ = store_.names();
  return *names_;
}

}  // namespace lapis::simulator
