#include "slam/map_saver.hpp"

#include <exception>
#include <utility>

namespace lapis::slam {

namespace {

constexpr int kPeriodPerSave = 20;  // shortest time from one save to the next, in times of what a save takes

}  // namespace

bool MapSaver::is_free() const { return !is_busy() && Clock::now() >= next_; }

void MapSaver::begin(const std::filesystem::path& path, SlamFile file) {
  began_ = Clock::now();
  writing_ = std::async(std::launch::async, [path = path.string(), file = std::move(file)]() -> Save {
    try {
      return {write_slam_file(path, file), Clock::now()};
    } catch (const std::exception& error) {  // for example, out of memory
      return {path + ": " + error.what(), Clock::now()};
    }
  });
}

std::optional<MapSaver::Save> MapSaver::take_finished() {
  if (!is_busy() || writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return note(writing_.get());
}

std::optional<MapSaver::Save> MapSaver::wait() {
  if (!is_busy()) return std::nullopt;
  return note(writing_.get());
}

MapSaver::Save MapSaver::note(Save save) {
  next_ = began_ + kPeriodPerSave * (save.ended - began_);
  return save;
}

}  // namespace lapis::slam
