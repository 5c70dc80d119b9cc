#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam::test {

/// TUM RGB-D folder: frames by associations.txt, camera by camera.yaml, T_world_camera by groundtruth.txt.
struct TumSequence {
  struct Entry {
    time::Time stamp;
    std::filesystem::path color, depth;
    geometry::Pose T_world_camera = geometry::Pose::Identity();
  };
  geometry::PinholeCamera camera;
  double depth_scale = 1000.0;
  std::vector<Entry> entries;

  RgbdFrame load(std::size_t index) const;
};

/// Throws with the file when there is no associations.txt or camera.yaml, or no frame.
TumSequence read_sequence(const std::filesystem::path& folder);
/// The shared recording `name` below LAPIS_TEST_DATA (default ../shared/data from the repository), or none.
std::optional<TumSequence> find_sequence(const std::string& name);

/// Root-mean-square position error after the best rigid alignment [Umeyama 1991], and after aligning the first poses.
double ate_se3(const std::vector<geometry::Pose>& truth, const std::vector<geometry::Pose>& estimate);
double ate_origin(const std::vector<geometry::Pose>& truth, const std::vector<geometry::Pose>& estimate);

}  // namespace lapis::slam::test
