#include "tests/support/small_scene.hpp"

#include <fstream>

namespace lapis::test {
namespace {

constexpr const char* kScene = R"(labels: labels.yaml
rooms:
  - {id: living, rect: [0, 0, 4, 3], floor: planks}
  - {id: hall, rect: [4.12, 0, 5.6, 3], floor: tiles}
openings:
  - {door: [4.06, 1.5]}
  - {window: [2, 0]}
furniture:
  - {class: sofa, room: living, wall: north, x: 1.2}
  - {id: table, class: table, size: [0.8, 0.5, 0.7], room: living, wall: west, y: 0.9}
  - {class: plant, on: table}
pictures:
  - {room: living, wall: south, x: 0.7}
  - {room: hall, wall: east, y: 1.5}
starts:
  - {at: [2, 1.2], yaw_deg: 90}
tour: [[3, 1.2], [4.8, 1.5], [2, 1.2]]
)";

constexpr const char* kLabels = R"(labels:
  - {id: 1, name: wall}
  - {id: 2, name: floor}
  - {id: 4, name: door}
  - {id: 5, name: table}
  - {id: 6, name: picture}
  - {id: 9, name: window}
  - {id: 10, name: sofa}
  - {id: 14, name: plant}
  - {id: 17, name: ceiling}
  - {id: 28, name: lighting}
)";

}  // namespace

std::filesystem::path write_small_scene(const std::filesystem::path& folder) {
  std::ofstream(folder / "labels.yaml") << kLabels;
  std::ofstream(folder / "scene.yaml") << kScene;
  return folder / "scene.yaml";
}

}  // namespace lapis::test
