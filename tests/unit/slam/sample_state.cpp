#include "tests/unit/slam/sample_state.hpp"

#include <random>

namespace lapis::slam::test {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr geometry::PinholeCamera kCamera{320, 240, 160.0, 161.5, 159.5, 119.5};

class Sampler {
 public:
  explicit Sampler(unsigned seed) : random_(seed) {}

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Pose pose() {
    geometry::Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = number(-1.5, 1.5);
    return geometry::se3_exp(xi);
  }
  Matrix6d information() {
    Matrix6d root;
    for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = number(-1.0, 1.0);
    return root * root.transpose() + 0.1 * Matrix6d::Identity();
  }
  Feature feature() {
    Feature feature;
    feature.pixel = {number(0.0, 319.0), number(0.0, 239.0)};
    feature.octave = static_cast<int>(random_() % 4);
    feature.depth_m = random_() % 4 == 0 ? 0.0 : number(0.5, 8.0);
    for (auto& word : feature.descriptor) word = (std::uint64_t{random_()} << 32) | random_();
    return feature;
  }
  SurfaceSample surface_sample() {
    const Eigen::Vector3d direction(number(-1.0, 1.0), number(-1.0, 1.0), -1.0);
    return {{number(-2.0, 2.0), number(-2.0, 2.0), number(0.5, 5.0)}, direction.normalized()};
  }
  Keyframe keyframe(KeyframeId id, int features, LandmarkId first_landmark) {
    Keyframe keyframe{id, time::Time::from_seconds(1.0 + 0.5 * static_cast<double>(id)), kCamera, pose(), {}, {}, {}};
    std::vector<Feature> seen;
    std::vector<SurfaceSample> surface;
    for (int i = 0; i < features; ++i) {
      seen.push_back(feature());
      surface.push_back(surface_sample());
      keyframe.landmarks.push_back(i % 4 == 3 ? kNoLandmark : first_landmark + static_cast<LandmarkId>(i));
    }
    keyframe.features = std::move(seen);
    keyframe.surface = std::move(surface);
    return keyframe;
  }

 private:
  std::mt19937 random_;
};

}  // namespace

SlamFile sample_file(unsigned seed, std::size_t keyframes, int features) {
  Sampler sampler(seed);
  SlamFile file;
  file.session = 123'456'789;
  file.epoch = 123'456'790;
  file.keyframe_ids.skip(keyframes / 2);
  file.depth_camera =
      SavedDepthCamera{{{640, 480, 585.0, 586.0, 320.0, 240.0}, {0.1, -0.2, 0.0, 0.0, 0.01}}, sampler.pose()};
  SlamState& state = file.state;
  state.scale_factor = 1.3;
  state.graph_version = keyframes + 2;
  state.reference = keyframes - 1;
  state.wheels = {1.02, 1e-4, 0.97, 4e-4, 1.5, 80.0};
  for (KeyframeId id = 0; id < keyframes; ++id) {
    // Every key-frame shows half of the landmarks of the one before.
    const auto first = static_cast<LandmarkId>(id * static_cast<std::size_t>(features) / 2);
    state.keyframes.push_back(sampler.keyframe(id, features, first));
    state.covariances.push_back(sampler.information());
    state.parts.push_back(kWholeMap);
    if (id == 0) continue;
    state.edges.push_back({id - 1, id, EdgeType::kOdometry, sampler.pose(), sampler.information()});
    state.edges.push_back({id - 1, id, EdgeType::kWheelOdometry, sampler.pose(), sampler.information()});
    state.links.push_back({id - 1, id, sampler.pose(), Matrix6d::Zero()});
  }
  const std::size_t landmarks = (keyframes + 1) * static_cast<std::size_t>(features);
  for (std::size_t i = 0; i < landmarks; ++i) {
    state.landmarks.push_back({{sampler.number(-9.0, 9.0), sampler.number(-9.0, 9.0), 0.1}, sampler.number(0.5, 20.0)});
  }
  const auto second = [](int s) { return time::Time::from_seconds(s); };
  state.motion = {second(4), {keyframes - 1, sampler.pose(), sampler.information()}, second(3), {}};
  for (int s = 2; s < 6; ++s) state.motion->odometry.push_back({second(s), sampler.pose()});
  return file;
}

}  // namespace lapis::slam::test
