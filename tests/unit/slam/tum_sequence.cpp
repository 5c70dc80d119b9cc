#include "tests/unit/slam/tum_sequence.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include <Eigen/SVD>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/test_data.hpp"

namespace lapis::slam::test {
namespace {

namespace fs = std::filesystem;
using geometry::Pose;

void read_camera(const fs::path& file, TumSequence& sequence) {
  std::ifstream stream(file);
  std::string key;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    double value = 0.0;
    if (!(words >> key >> value)) continue;
    if (key == "width:") sequence.camera.width = static_cast<int>(value);
    if (key == "height:") sequence.camera.height = static_cast<int>(value);
    if (key == "fx:") sequence.camera.fx = value;
    if (key == "fy:") sequence.camera.fy = value;
    if (key == "cx:") sequence.camera.cx = value;
    if (key == "cy:") sequence.camera.cy = value;
    if (key == "depth_scale:") sequence.depth_scale = value;
  }
}

// The true pose of a frame is the one with the nearest stamp: these recordings have one for each frame.
void read_truth(const fs::path& file, TumSequence& sequence) {
  std::ifstream stream(file);
  std::map<double, Pose> truth;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    double stamp = 0.0, x = 0.0, y = 0.0, z = 0.0, qx = 0.0, qy = 0.0, qz = 0.0, qw = 1.0;
    words >> stamp >> x >> y >> z >> qx >> qy >> qz >> qw;
    truth[stamp] = geometry::make_pose({x, y, z}, {qw, qx, qy, qz});
  }
  if (truth.empty()) return;
  for (auto& entry : sequence.entries) {
    const double stamp = entry.stamp.seconds();
    auto nearest = truth.lower_bound(stamp);
    if (nearest == truth.end() ||
        (nearest != truth.begin() && stamp - std::prev(nearest)->first < nearest->first - stamp)) {
      --nearest;
    }
    entry.T_world_camera = nearest->second;
  }
}

double rms(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, const Pose& T_truth_estimate) {
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    squares += (truth[i].translation() - T_truth_estimate * estimate[i].translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(truth.size()));
}

}  // namespace

RgbdFrame TumSequence::load(std::size_t index) const {
  const Entry& entry = entries.at(index);
  const cv::Mat color = cv::imread(entry.color.string(), cv::IMREAD_COLOR);
  const cv::Mat depth = cv::imread(entry.depth.string(), cv::IMREAD_UNCHANGED);
  RgbdFrame frame{entry.stamp, camera, geometry::GrayImage(color.cols, color.rows),
                  geometry::DepthImage(depth.cols, depth.rows)};
  for (int y = 0; y < color.rows; ++y) {
    for (int x = 0; x < color.cols; ++x) {
      const auto& bgr = color.at<cv::Vec3b>(y, x);
      frame.gray(x, y) = static_cast<std::uint8_t>((77 * bgr[2] + 150 * bgr[1] + 29 * bgr[0] + 128) >> 8);
    }
  }
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      frame.depth(x, y) = static_cast<float>(depth.at<std::uint16_t>(y, x) / depth_scale);
    }
  }
  return frame;
}

TumSequence read_sequence(const fs::path& folder) {
  std::ifstream associations(folder / "associations.txt");
  TumSequence sequence;
  std::string color_stamp, color, depth_stamp, depth;
  while (associations >> color_stamp >> color >> depth_stamp >> depth) {
    sequence.entries.push_back(
        {time::Time::from_seconds(std::stod(color_stamp)), folder / color, folder / depth, Pose::Identity()});
  }
  read_camera(folder / "camera.yaml", sequence);
  if (sequence.entries.empty()) throw std::runtime_error((folder / "associations.txt").string() + " lists no frames");
  if (!geometry::is_valid(sequence.camera)) {
    throw std::runtime_error((folder / "camera.yaml").string() + " has no camera (width, height, fx, fy, cx, cy)");
  }
  read_truth(folder / "groundtruth.txt", sequence);
  return sequence;
}

std::optional<TumSequence> find_sequence(const std::string& name) {
  const auto found = lapis::test::find_test_data("rgbd/" + name);
  if (!found) return std::nullopt;
  return read_sequence(*found);
}

double ate_se3(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  Eigen::Matrix3Xd to(3, truth.size()), from(3, truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    to.col(static_cast<Eigen::Index>(i)) = truth[i].translation();
    from.col(static_cast<Eigen::Index>(i)) = estimate[i].translation();
  }
  return rms(truth, estimate, Pose(Eigen::umeyama(from, to, false)));
}

double ate_origin(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  return rms(truth, estimate, truth.front() * estimate.front().inverse());
}

}  // namespace lapis::slam::test
