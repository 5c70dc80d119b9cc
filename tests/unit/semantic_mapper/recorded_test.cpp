#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include <gtest/gtest.h>

#include "semantic_mapper/core/semantic_mapper.hpp"
#include "tests/support/test_data.hpp"

namespace lapis::semantic_mapper {
namespace {

namespace fs = std::filesystem;

std::vector<geometry::Pose> read_poses(const fs::path& file) {
  std::ifstream in(file);
  std::vector<geometry::Pose> poses;
  for (std::string line; std::getline(in, line);) {
    double t, x, y, z, qx, qy, qz, qw;
    if (std::istringstream(line) >> t >> x >> y >> z >> qx >> qy >> qz >> qw)
      poses.push_back(geometry::make_pose({x, y, z}, Eigen::Quaterniond(qw, qx, qy, qz)));
  }
  return poses;
}

template <class Pixel, class Source>
geometry::Image<Pixel> convert(const cv::Mat& image, double scale) {
  geometry::Image<Pixel> out(image.cols, image.rows);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      out(column, row) = static_cast<Pixel>(image.at<Source>(row, column) * scale);
  return out;
}

/// A map that forgets nothing that was seen must stay filled: nine of ten voxels that any pixel of any frame fell into
/// are occupied, although all rays of all frames carve.
TEST(RecordedSequence, CarvingKeepsNineOfTenSeenVoxels) {
  const auto found = lapis::test::find_test_data("rgbd/aws_small_house_loop");
  if (!found) GTEST_SKIP() << lapis::test::missing_test_data("rgbd/aws_small_house_loop");
  const fs::path& folder = *found;
  const geometry::PinholeCamera camera{640, 360, 320, 320, 319.5, 179.5};
  const std::vector<geometry::Pose> poses = read_poses(folder / "groundtruth.txt");
  ASSERT_EQ(poses.size(), 268u);
  SemanticMapper mapper(MapperConfig{});
  std::set<mapping::VoxelIndex> seen;
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    const std::string number = std::to_string(i), name = std::string(5 - number.size(), '0') + number + ".png";
    const auto depth = convert<float, std::uint16_t>(cv::imread(folder / "depth" / name, cv::IMREAD_UNCHANGED), 1e-3);
    const auto labels =
        convert<std::uint16_t, std::uint8_t>(cv::imread(folder / "label" / name, cv::IMREAD_UNCHANGED), 1.0);
    std::string error;
    mapper.integrate({{},
                      i,
                      poses[i],
                      geometry::Pose::Identity(),
                      1,
                      mapping::CompactFrame::make(camera, depth, &labels, {2, 40}, error).value()});
    for (int row = 0; row < depth.height; ++row)
      for (int column = 0; column < depth.width; ++column) {
        const Eigen::Vector3d p = camera.unproject(column, row, depth(column, row));
        if (depth(column, row) > 0 && p.norm() >= 0.2 && p.norm() <= 5.0)
          seen.insert(mapper.map().index_of(poses[i] * p));
      }
  }
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  std::size_t occupied = 0;
  for (const mapping::VoxelIndex& voxel : seen) occupied += reader.is_occupied(mapper.map().read(voxel)) ? 1 : 0;
  const double share = static_cast<double>(occupied) / static_cast<double>(seen.size());
  std::cout << "occupied " << occupied << " of " << seen.size() << " seen voxels: " << share << "\n"
            << mapper.frame_bytes() / mapper.frames().size() << " bytes per stored frame\n";
  EXPECT_GE(share, 0.9);
}

}  // namespace
}  // namespace lapis::semantic_mapper
