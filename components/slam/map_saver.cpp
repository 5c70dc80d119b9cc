#include "slam/map_saver.hpp"

#include <chrono>
#include <exception>
#include <utility>

namespace lapis::slam {

void MapSaver::begin(const std::filesystem::path& path, SlamFile file) {
  writing_ = std::async(std::launch::async, [path = path.string(), file = std::move(file)]() -> Save {
    try {
      return {write_slam_file(path, file)};
    } catch (const std::exception& error) {  // for example, out of memory
      return {path + ": " + error.what()};
    }
  });
}

std::optional<MapSaver::Save> MapSaver::take_finished() {
  if (!is_busy() || writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return writing_.get();
}

std::optional<MapSaver::Save> MapSaver::wait() {
  if (!is_busy()) return std::nullopt;
  return writing_.get();
}

}  // namespace lapis::slam
