// Keeps a mirror of the mapper's map, as the planner does, and prints a line for each version that it has completed:
//   map EPOCH VERSION TILES
// When SIGUSR1 comes, it prints whether the mirror is equal to a saved map, the file of its argument: "saved map:
// same", or what is not so. It ends on SIGTERM.

#include <csignal>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>

#include "common/mapping/file/map_file.hpp"
#include "common/mapping/wire/map_mirror.hpp"
#include "common/topics/map.hpp"
#include "tests/support/topic_probe.hpp"

namespace lapis::test {
namespace {

volatile std::sig_atomic_t is_asked_to_stop = 0;
volatile std::sig_atomic_t is_asked_to_compare = 0;

mapping::MapState to_state(const lapis_msgs::msg::MapState& message) {
  mapping::MapState state;
  state.epoch = message.epoch();
  state.version = message.version();
  state.tiles = message.tiles();
  state.checksum = message.checksum();
  state.resolution_m = message.resolution_m();
  return state;
}

class MapProbe {
 public:
  explicit MapProbe(TopicProbe& probe) {
    probe.listen<lapis_msgs::msg::VoxelTile>(topics::kVoxelTiles, [this](auto& m) {
      mirror_.apply_tile(m.epoch(), {m.x(), m.y(), m.z()}, m.version(), m.data());
      report();
    });
    probe.listen<lapis_msgs::msg::MapState>(topics::kMapState, [this](auto& m) {
      mirror_.apply_state(to_state(m));
      report();
    });
  }

  bool is_equal_to(const mapping::VoxelMap& saved) const {
    return mirror_.is_consistent() && mirror_.map() != nullptr && *mirror_.map() == saved;
  }
  std::string describe() const {
    if (mirror_.map() == nullptr) return "no map has come";
    return mirror_.is_consistent() ? "the newest version differs" : "tiles of the newest version are missing";
  }

 private:
  void report() {
    if (!mirror_.is_consistent()) return;
    const mapping::MapState& state = *mirror_.state();
    if (std::exchange(reported_, {state.epoch, state.version}) == std::pair(state.epoch, state.version)) return;
    std::cout << "map " << state.epoch << ' ' << state.version << ' ' << state.tiles << std::endl;
  }

  mapping::MapMirror mirror_;
  std::pair<std::int64_t, std::uint64_t> reported_{-1, 0};
};

/// What the mapper wrote last may still have to be taken.
std::string compare(TopicProbe& probe, const MapProbe& map, const std::string& file) {
  std::string error;
  const auto saved = mapping::load_map(file, error);
  if (!saved) return error;
  const bool is_same = probe.wait_until([&] { return map.is_equal_to(saved->map); }, Seconds(3));
  return is_same ? "same" : map.describe();
}

}  // namespace
}  // namespace lapis::test

int main(int argc, char** argv) {
  using namespace lapis::test;
  if (argc != 2) {
    std::cerr << "use: lapis_map_probe MAP.lapis\n";
    return 2;
  }
  std::signal(SIGTERM, [](int) { is_asked_to_stop = 1; });
  std::signal(SIGUSR1, [](int) { is_asked_to_compare = 1; });
  TopicProbe probe("map_probe");
  const MapProbe map(probe);
  std::cout << "map_probe: ready" << std::endl;
  while (is_asked_to_stop == 0) {
    probe.wait_until([] { return is_asked_to_stop != 0 || is_asked_to_compare != 0; }, Seconds(1));
    if (std::exchange(is_asked_to_compare, 0) != 0)
      std::cout << "saved map: " << compare(probe, map, argv[1]) << std::endl;
  }
  return 0;
}
