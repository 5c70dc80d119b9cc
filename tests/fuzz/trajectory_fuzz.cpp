// TUM text of trajectories.

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/trajectory/trajectory.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapis;
  try {
    const auto poses = trajectory::parse_trajectory({reinterpret_cast<const char*>(data), size}, "fuzz");
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!geometry::is_valid(poses[i].T_world_body)) std::abort();
      if (i > 0 && !(poses[i - 1].stamp < poses[i].stamp)) std::abort();
    }
    const std::string text = trajectory::format_trajectory(poses, "fuzz");
    if (trajectory::parse_trajectory(text, "written").size() != poses.size()) std::abort();
    if (!poses.empty()) {
      trajectory::pose_at(poses, poses.front().stamp, time::Duration::from_seconds(1.0));
      trajectory::path_length_m(poses);
    }
  } catch (const std::runtime_error& error) {
    if (std::string_view(error.what()).rfind("fuzz:", 0) != 0) std::abort();
  }
  return 0;
}
