#include "slam/core/files/slam_file.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/slam/sample_state.hpp"

namespace lapis::slam {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Why bytes are refused; empty when they are read.
std::string refusal(std::span<const std::uint8_t> bytes) {
  std::string error;
  const auto file = decode_slam_file(bytes, error);
  EXPECT_EQ(file.has_value(), error.empty()) << error;
  return error;
}

// The same for a state that a writer with a bug would write.
template <class Change>
std::string refusal_of(Change change) {
  SlamFile file = test::sample_file(1, 3);
  change(file.state);
  return refusal(encode_slam_file(file));
}

template <class T, class Change>
void change_first(SharedArray<T>& array, Change change) {
  std::vector<T> copy = array;
  change(copy.front());
  array = std::move(copy);
}

TEST(SlamFile, ReadEqualsWritten) {
  const SlamFile file = test::sample_file(1, 5, 20);
  std::string error;
  const auto read = decode_slam_file(encode_slam_file(file), error);
  ASSERT_TRUE(read) << error;
  EXPECT_EQ(read->session, file.session);
  const SlamState &a = read->state, &b = file.state;
  EXPECT_EQ(a.scale_factor, b.scale_factor);
  EXPECT_EQ(a.graph_version, b.graph_version);
  EXPECT_EQ(a.reference, b.reference);
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < b.keyframes.size(); ++i) {
    const Keyframe &read_one = a.keyframes[i], &one = b.keyframes[i];
    EXPECT_EQ(read_one.id, one.id);
    EXPECT_EQ(read_one.stamp, one.stamp);
    EXPECT_EQ(read_one.camera, one.camera);
    EXPECT_EQ(read_one.T_map_camera.matrix(), one.T_map_camera.matrix());
    EXPECT_EQ(read_one.landmarks, one.landmarks);
    EXPECT_EQ(a.covariances[i], Eigen::MatrixXd(b.covariances[i].selfadjointView<Eigen::Upper>()));
    ASSERT_EQ(read_one.features.size(), one.features.size());
    for (std::size_t k = 0; k < one.features.size(); ++k) {
      EXPECT_LT((read_one.features[k].pixel - one.features[k].pixel).norm(), 1e-4);
      EXPECT_NEAR(read_one.features[k].depth_m, one.features[k].depth_m, 1e-6);
      EXPECT_EQ(read_one.features[k].octave, one.features[k].octave);
      EXPECT_EQ(read_one.features[k].descriptor, one.features[k].descriptor);
      EXPECT_LT((read_one.surface[k].point - one.surface[k].point).norm(), 1e-6);
      EXPECT_LT((read_one.surface[k].normal - one.surface[k].normal).norm(), 1e-4);
    }
  }
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  EXPECT_EQ(a.landmarks.back().p_map, b.landmarks.back().p_map);
  EXPECT_NEAR(a.landmarks.back().finest_distance_m, b.landmarks.back().finest_distance_m, 1e-5);
  ASSERT_EQ(a.edges.size(), b.edges.size());
  EXPECT_EQ(a.edges[1].type, b.edges[1].type);
  EXPECT_EQ(a.edges[1].from, b.edges[1].from);
  EXPECT_EQ(a.edges[1].to, b.edges[1].to);
  EXPECT_EQ(a.edges[1].T_from_to.matrix(), b.edges[1].T_from_to.matrix());
  ASSERT_EQ(a.links.size(), b.links.size());
  EXPECT_EQ(a.links[0].T_from_to.matrix(), b.links[0].T_from_to.matrix());
  EXPECT_EQ(a.wheels, b.wheels);
  EXPECT_EQ(read->epoch, file.epoch);
  EXPECT_EQ(read->keyframe_ids.stretches, file.keyframe_ids.stretches);
  ASSERT_TRUE(a.motion);
  EXPECT_EQ(a.motion->stamp, b.motion->stamp);
  EXPECT_EQ(a.motion->held_stamp, b.motion->held_stamp);
  EXPECT_EQ(a.motion->camera.reference, b.motion->camera.reference);
  EXPECT_EQ(a.motion->camera.T_reference_camera.matrix(), b.motion->camera.T_reference_camera.matrix());
  ASSERT_EQ(a.motion->odometry.size(), b.motion->odometry.size());
  EXPECT_EQ(a.motion->odometry.back().stamp, b.motion->odometry.back().stamp);
  EXPECT_EQ(a.motion->odometry.back().T_odom_base.matrix(), b.motion->odometry.back().T_odom_base.matrix());
  ASSERT_TRUE(read->depth_camera);
  EXPECT_EQ(read->depth_camera->camera, file.depth_camera->camera);
  EXPECT_EQ(read->depth_camera->T_color_depth.matrix(), file.depth_camera->T_color_depth.matrix());
}

// Bytes of the file as an older version wrote it: without the sections from `first_missing` on.
Bytes older_version(std::uint8_t version, std::string_view first_missing) {
  constexpr std::size_t kVersionAt = 8;
  Bytes bytes = encode_slam_file(test::sample_file(1, 3));
  const auto at = std::search(bytes.begin(), bytes.end(), first_missing.begin(), first_missing.end());
  EXPECT_NE(at, bytes.end());
  bytes.erase(at, bytes.end());
  bytes[kVersionAt] = version;
  return bytes;
}

TEST(SlamFile, AMapOfTheFourthVersionHasNoSubMaps) {
  std::string error;
  const auto read = decode_slam_file(older_version(4, "PART"), error);
  ASSERT_TRUE(read) << error;
  EXPECT_TRUE(read->state.parts.empty());
  EXPECT_TRUE(read->depth_camera);
}

TEST(SlamFile, AMapOfTheThirdVersionHasNoDepthCamera) {
  std::string error;
  const auto read = decode_slam_file(older_version(3, "DEPC"), error);
  ASSERT_TRUE(read) << error;
  EXPECT_FALSE(read->depth_camera);
  EXPECT_TRUE(read->state.motion);
}

TEST(SlamFile, AMapOfTheSecondVersionHasTheIdsOfItsElementsAndNoMotion) {
  std::string error;
  const auto read = decode_slam_file(older_version(2, "NAME"), error);
  ASSERT_TRUE(read) << error;
  EXPECT_EQ(read->keyframe_ids.of(2), 2U);
  EXPECT_FALSE(read->state.motion);
  EXPECT_NE(read->state.wheels, WheelCalibration{});
}

TEST(SlamFile, AMapOfTheFirstVersionHasWheelsThatNobodyKnows) {
  std::string error;
  const auto read = decode_slam_file(older_version(1, "WHEE"), error);
  ASSERT_TRUE(read) << error;
  EXPECT_EQ(read->state.wheels, WheelCalibration{});
  EXPECT_EQ(read->state.keyframes.size(), 3U);
}

TEST(SlamFile, EqualContentGivesEqualBytesAndReadingLosesNothingMore) {
  const Bytes bytes = encode_slam_file(test::sample_file(2, 5, 20));
  EXPECT_EQ(bytes, encode_slam_file(test::sample_file(2, 5, 20)));
  EXPECT_NE(bytes, encode_slam_file(test::sample_file(3, 5, 20)));
  std::string error;
  const auto read = decode_slam_file(bytes, error);
  ASSERT_TRUE(read) << error;
  EXPECT_EQ(encode_slam_file(*read), bytes);
}

TEST(SlamFile, EveryFlippedBitAndEveryTruncationIsRefused) {
  const Bytes good = encode_slam_file(test::sample_file(1, 2));
  ASSERT_EQ(refusal(good), "");
  for (std::size_t size = 0; size < good.size(); ++size) ASSERT_NE(refusal(std::span(good).first(size)), "") << size;
  Bytes bad = good;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
    ASSERT_NE(refusal(bad), "") << "bit " << bit;
    bad[bit / 8] = good[bit / 8];
  }
  bad.push_back(0);
  EXPECT_EQ(refusal(bad), "has bytes after its end");
}

TEST(SlamFile, RandomDamageOfALargerFileIsRefused) {
  const Bytes good = encode_slam_file(test::sample_file(4, 12, 40));
  std::mt19937 random(5);
  for (int trial = 0; trial < 10'000; ++trial) {
    Bytes bad = good;
    if (trial % 4 == 0) bad.resize(random() % good.size());
    if (trial % 4 != 0) bad[random() % bad.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    ASSERT_NE(refusal(bad), "") << trial;
  }
}

// Changes content below the checksums, as a forger would: whatever is read is a sound map or a reason.
TEST(SlamFile, WrongContentWithRightChecksumsNeverCrashes) {
  constexpr std::size_t kHeader = 12, kSectionHeader = 16;
  const Bytes good = encode_slam_file(test::sample_file(6, 3));
  std::mt19937 random(7);
  int read = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    Bytes bad = good;
    for (int i = 0; i <= trial % 3; ++i) bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    for (std::size_t at = kHeader; at + kSectionHeader <= bad.size();) {
      const std::uint64_t size = files::ByteReader(std::span(good).subspan(at + 8)).u64();
      files::ByteWriter section;
      section.u64(size);
      section.raw(std::span(bad).subspan(at + kSectionHeader, size));
      files::ByteWriter checksum;
      checksum.u32(files::crc32(section.bytes()));
      std::copy_n(checksum.bytes().begin(), 4, bad.begin() + static_cast<std::ptrdiff_t>(at + 4));
      std::copy_n(section.bytes().begin(), 8, bad.begin() + static_cast<std::ptrdiff_t>(at + 8));
      at += kSectionHeader + size;
    }
    read += refusal(bad).empty() ? 1 : 0;
  }
  EXPECT_GT(read, 500) << "the checksums have not been made right";
  EXPECT_LT(read, 4500);
}

TEST(SlamFile, AStateThatCannotBeIsRefusedByName) {
  using State = SlamState;
  EXPECT_EQ(refusal_of([](State&) {}), "");
  const std::vector<std::pair<std::string, std::function<void(State&)>>> faults{
      {"no key-frames", [](State& s) { s = SlamState{}; }},
      {"graph version 0", [](State& s) { s.graph_version = 0; }},
      {"the reference key-frame does not exist", [](State& s) { s.reference = 3; }},
      {"scale factor", [](State& s) { s.scale_factor = kNaN; }},
      {"covariances differ in number", [](State& s) { s.covariances.pop_back(); }},
      {"covariance 1", [](State& s) { s.covariances[1](2, 2) = -1.0; }},
      {"key-frame 2: wrong id", [](State& s) { s.keyframes[2].id = 7; }},
      {"key-frame 2: stamp", [](State& s) { s.keyframes[2].stamp.nanoseconds = -1; }},
      {"key-frame 1: invalid camera", [](State& s) { s.keyframes[1].camera.fx = 0.0; }},
      {"key-frame 1: pose", [](State& s) { s.keyframes[1].T_map_camera.translation().x() = kNaN; }},
      {"key-frame 1: pose", [](State& s) { s.keyframes[1].T_map_camera.linear() *= 1.1; }},
      {"landmark 999 does not exist", [](State& s) { s.keyframes[0].landmarks[0] = 999; }},
      {"two features show landmark", [](State& s) { s.keyframes[0].landmarks[0] = s.keyframes[0].landmarks[1]; }},
      {"differ in number", [](State& s) { s.keyframes[0].landmarks.pop_back(); }},
      {"feature 0: pixel",
       [](State& s) { change_first(s.keyframes[0].features, [](Feature& f) { f.pixel.x() = 320.0; }); }},
      {"feature 0: depth",
       [](State& s) { change_first(s.keyframes[0].features, [](Feature& f) { f.depth_m = -1.0; }); }},
      {"feature 0: octave", [](State& s) { change_first(s.keyframes[0].features, [](Feature& f) { f.octave = 40; }); }},
      {"surface sample 0: point",
       [](State& s) { change_first(s.keyframes[0].surface, [](SurfaceSample& f) { f.point.z() = kNaN; }); }},
      {"surface sample 0: normal",
       [](State& s) { change_first(s.keyframes[0].surface, [](SurfaceSample& f) { f.normal.setZero(); }); }},
      {"landmark 4: position", [](State& s) { s.landmarks[4].p_map.y() = kNaN; }},
      {"landmark 4: distance", [](State& s) { s.landmarks[4].finest_distance_m = 0.0; }},
      {"edge 1: joins a key-frame that does not exist", [](State& s) { s.edges[1].to = 3; }},
      {"edge 1: joins a key-frame with itself", [](State& s) { s.edges[1].to = s.edges[1].from; }},
      {"edge 1: pose", [](State& s) { s.edges[1].T_from_to.linear().setZero(); }},
      {"edge 1: information", [](State& s) { s.edges[1].information(0, 5) = kNaN; }},
      {"edge 1: information is not positive definite", [](State& s) { s.edges[1].information.setZero(); }},
      {"edge 1: unknown type", [](State& s) { s.edges[1].type = static_cast<EdgeType>(9); }},
      {"calibration of the wheels: scale", [](State& s) { s.wheels.distance_scale = 0.0; }},
      {"calibration of the wheels: scale", [](State& s) { s.wheels.turn_variance = kNaN; }},
      {"calibration of the wheels: noise", [](State& s) { s.wheels.noise = 0.0; }},
      {"calibration of the wheels: number", [](State& s) { s.wheels.motions = -1.0; }},
      {"motion: stamp", [](State& s) { s.motion->held_stamp.nanoseconds = -1; }},
      {"motion: its key-frame", [](State& s) { s.motion->camera.reference = 3; }},
      {"motion: pose", [](State& s) { s.motion->camera.T_reference_camera.linear().setZero(); }},
      {"motion: covariance", [](State& s) { s.motion->camera.covariance(1, 1) = kNaN; }},
      {"motion: odometry", [](State& s) { s.motion->odometry[2].T_odom_base.translation().x() = kNaN; }},
      {"link 1: joins", [](State& s) { s.links[1].from = 8; }},
      {"parts of the map: their number", [](State& s) { s.parts.pop_back(); }},
      {"parts of the map: that of key-frame 1",
       [](State& s) {
         s.parts = {0, 2, 2};
       }},
      {"parts of the map: that of key-frame 2",
       [](State& s) {
         s.parts = {0, 0, 1};
       }},
      {"parts of the map: an edge connects",
       [](State& s) {
         s.parts = {0, 0, 2};
       }},
  };
  for (const auto& [name, change] : faults) {
    const std::string error = refusal_of(change);
    EXPECT_NE(error.find(name), std::string::npos) << "expected '" << name << "', got '" << error << "'";
  }
}

TEST(SlamFile, ErrorsNameFileVersionAndSection) {
  const lapis::test::TemporaryFolder folder;
  std::string error;
  EXPECT_FALSE(read_slam_file((folder.path() / "absent.lapis").string(), error));
  EXPECT_NE(error.find("absent.lapis"), std::string::npos);
  std::ofstream(folder.path() / "text.lapis") << "this is not a map, but long enough to be one";
  EXPECT_FALSE(read_slam_file((folder.path() / "text.lapis").string(), error));
  EXPECT_NE(error.find("text.lapis: is not a map saved by lapis_slam"), std::string::npos) << error;
  const auto failure = write_slam_file((folder.path() / "no_such/slam.lapis").string(), test::sample_file(1, 1));
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("no_such/slam.lapis"), std::string::npos);

  Bytes bytes = encode_slam_file(test::sample_file(1, 2));
  bytes.back() ^= 1U;
  EXPECT_EQ(refusal(bytes), "is damaged: its section PART has another checksum than when it was written");
  SlamFile timeless = test::sample_file(1, 1);
  timeless.session = -1;
  EXPECT_EQ(refusal(encode_slam_file(timeless)), "has a session out of range");
  SlamFile nameless = test::sample_file(1, 1);
  nameless.keyframe_ids.stretches = {{5, 10}, {4, 20}};
  EXPECT_EQ(refusal(encode_slam_file(nameless)), "has published ids or an epoch out of range");
  SlamFile blind = test::sample_file(1, 1);
  blind.depth_camera->camera.pinhole.fx = 0.0;
  EXPECT_EQ(refusal(encode_slam_file(blind)), "has a depth camera that cannot be");
  SlamFile strange = test::sample_file(1, 1);
  strange.depth_camera->camera.distortion.resize(6);
  EXPECT_EQ(refusal(encode_slam_file(strange)), "has a depth camera that cannot be");
  bytes[8] = 9;
  EXPECT_EQ(refusal(bytes), "has format version 9, this program reads 1 to 5");
}

TEST(SlamFile, OldFileStaysWholeWhenThereIsNoSpace) {
  const lapis::test::TemporaryFolder folder;
  const std::string path = (folder.path() / "slam.lapis").string();
  const SlamFile old = test::sample_file(1, 2);
  ASSERT_EQ(write_slam_file(path, old), std::nullopt);
  // A file size limit makes write() fail as a full disk does.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1024, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto failure = write_slam_file(path, test::sample_file(2, 20));
  ::setrlimit(RLIMIT_FSIZE, &before);
  static_cast<void>(std::signal(SIGXFSZ, handler));

  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find(path), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  std::string error;
  const auto read = read_slam_file(path, error);
  ASSERT_TRUE(read) << error;
  std::string none;
  EXPECT_EQ(encode_slam_file(*read), encode_slam_file(*decode_slam_file(encode_slam_file(old), none)));
}

TEST(SlamState, RestoresTheMapThatItWasMadeFrom) {
  const SlamState state = test::sample_file(1, 4, 8).state;
  const Map map = restore_map(state);
  ASSERT_EQ(map.keyframes().size(), state.keyframes.size());
  ASSERT_EQ(map.landmarks().size(), state.landmarks.size());
  std::size_t alive = 0;
  for (LandmarkId id = 0; id < state.landmarks.size(); ++id) {
    const Landmark& landmark = map.landmark(id);
    EXPECT_EQ(landmark.p_map, state.landmarks[id].p_map);
    alive += landmark.observations.empty() ? 0U : 1U;
    for (const Observation& o : landmark.observations) {
      EXPECT_EQ(map.keyframe(o.keyframe).landmarks[static_cast<std::size_t>(o.feature)], id);
    }
    if (landmark.observations.empty()) continue;
    const Observation& newest = landmark.observations.back();
    EXPECT_EQ(landmark.descriptor,
              map.keyframe(newest.keyframe).features[static_cast<std::size_t>(newest.feature)].descriptor);
  }
  EXPECT_EQ(map.landmark_count(), alive);
  EXPECT_LT(alive, state.landmarks.size());
  for (const Keyframe& keyframe : state.keyframes) EXPECT_EQ(map.keyframe(keyframe.id).landmarks, keyframe.landmarks);
}

TEST(SlamState, ACalibrationIsNoOtherCamera) {
  const geometry::PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  geometry::PinholeCamera other = camera;
  EXPECT_TRUE(is_same_camera(camera, other));
  other.fx += 3.0;
  EXPECT_TRUE(is_same_camera(camera, other));
  other.fx += 30.0;
  EXPECT_FALSE(is_same_camera(camera, other));
  other = camera;
  other.height = 360;
  EXPECT_FALSE(is_same_camera(camera, other));
}

}  // namespace
}  // namespace lapis::slam
