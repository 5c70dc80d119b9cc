#include "semantic_mapper/core/semantic_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "common/mapping/map_file.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;

const geometry::PinholeCamera kCamera{80, 45, 40, 40, 39.5, 22.0};

mapping::CompactFrame frame_at(const Pose& T_map_camera) {
  static const auto room = lapis::test::furnished_room();
  const auto image = lapis::test::render(room, kCamera, T_map_camera);
  std::string error;
  return mapping::CompactFrame::make(kCamera, image.depth, &image.labels, {1, 40}, error).value();
}

Pose small_motion(std::mt19937& random, double size) {
  std::normal_distribution<double> n(0.0, size);
  geometry::Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = n(random);
  return geometry::se3_exp(xi);
}

/// A tour of 40 frames on 8 key-frames.
struct Tour {
  std::vector<KeyframePose> keyframes;
  std::vector<AnchoredFrame> frames;
};

Tour make_tour() {
  Tour tour;
  for (std::uint64_t k = 0; k < 8; ++k) {
    const double angle = static_cast<double>(k) * M_PI / 4;
    const Pose T_map_keyframe = lapis::test::look({2 * std::cos(angle), std::sin(angle), 1.0}, angle + 2.0, 0.15);
    tour.keyframes.push_back({100 + k, T_map_keyframe});
    for (int i = 0; i < 5; ++i) {
      const Pose T_keyframe_camera =
          geometry::se3_exp((geometry::Vector6d() << 0.02 * i, 0, 0.03 * i, 0, 0.04 * i, 0).finished());
      tour.frames.push_back({time::Time{static_cast<std::int64_t>(tour.frames.size())}, 100 + k, T_map_keyframe,
                             T_keyframe_camera, 1, frame_at(T_map_keyframe * T_keyframe_camera)});
    }
  }
  return tour;
}

const Tour& tour() {
  static const Tour kTour = make_tour();
  return kTour;
}

mapping::VoxelMap built_from_records(const SemanticMapper& mapper) {
  mapping::VoxelMap map(mapper.config().resolution_m);
  for (const StoredFrame& frame : mapper.frames())
    map.add(mapping::compute_votes(frame.frame.unpack(), frame.T_map_camera, mapper.config().integration,
                                   mapper.config().resolution_m));
  return map;
}

SemanticMapper mapper_with_tour(const MapperConfig& config = {}) {
  SemanticMapper mapper(config);
  for (const AnchoredFrame& frame : tour().frames)
    EXPECT_EQ(mapper.integrate(frame).status, IntegrationStatus::kIntegrated);
  return mapper;
}

std::vector<KeyframePose> corrected(std::mt19937& random, double size) {
  std::vector<KeyframePose> poses = tour().keyframes;
  for (KeyframePose& pose : poses) pose.T_map_keyframe = small_motion(random, size) * pose.T_map_keyframe;
  return poses;
}

TEST(SemanticMapper, EqualsBuildFromRecordsAtEveryInstantAndFromScratchAfterFlush) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    MapperConfig config;
    config.resolution_m = seed % 2 == 0 ? 0.25 : 0.1;
    SemanticMapper mapper(config);
    std::vector<KeyframePose> last = tour().keyframes;
    std::uint64_t version = 1;
    for (std::size_t i = 0; i < tour().frames.size(); ++i) {
      AnchoredFrame frame = tour().frames[i];
      frame.graph_version = version;
      const auto known =
          std::find_if(last.begin(), last.end(), [&](const auto& k) { return k.id == frame.keyframe_id; });
      frame.T_map_keyframe = known->T_map_keyframe;
      mapper.integrate(frame);
      if (i % 7 == 6) mapper.update_keyframe_poses(++version, last = corrected(random, 0.05));
      mapper.re_anchor(2);
      ASSERT_EQ(mapper.map(), built_from_records(mapper)) << "after frame " << i;
    }
    EXPECT_GT(mapper.flush(), 0u);
    EXPECT_EQ(mapper.map(), built_from_records(mapper));
    EXPECT_EQ(mapper.frames_off(), 0u);

    SemanticMapper scratch(config);
    for (AnchoredFrame frame : tour().frames) {
      for (const KeyframePose& k : last)
        if (k.id == frame.keyframe_id) frame.T_map_keyframe = k.T_map_keyframe;
      scratch.integrate(frame);
    }
    EXPECT_EQ(mapper.map(), scratch.map());
    EXPECT_EQ(mapper.flush(), 0u);
  }
}

TEST(SemanticMapper, OrderOfFramesDoesNotMatter) {
  std::vector<AnchoredFrame> shuffled = tour().frames;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
  SemanticMapper mapper(MapperConfig{});
  for (const AnchoredFrame& frame : shuffled) mapper.integrate(frame);
  EXPECT_EQ(mapper.map(), mapper_with_tour().map());
}

TEST(SemanticMapper, ThresholdDecidesWhichFramesMoveAndSlicesAreBounded) {
  SemanticMapper mapper = mapper_with_tour();
  std::vector<KeyframePose> poses = tour().keyframes;
  poses[2].T_map_keyframe.translation().x() += 0.3;    // 1.2 voxels
  poses[5].T_map_keyframe.translation().x() += 0.001;  // far below 0.2 voxel
  mapper.update_keyframe_poses(2, poses);
  EXPECT_EQ(mapper.frames_off(), 5u);
  EXPECT_EQ(mapper.re_anchor(3), 3u);
  EXPECT_EQ(mapper.frames_off(), 2u);
  EXPECT_EQ(mapper.re_anchor(100), 2u);
  EXPECT_EQ(mapper.re_anchor(100), 0u);
  EXPECT_EQ(mapper.flush(), 5u);
}

TEST(SemanticMapper, ACorrectionThatIsTakenBackNeedsNoMove) {
  SemanticMapper mapper = mapper_with_tour();
  std::vector<KeyframePose> poses = tour().keyframes;
  poses[2].T_map_keyframe.translation().x() += 0.3;
  mapper.update_keyframe_poses(2, poses);
  mapper.update_keyframe_poses(3, tour().keyframes);
  EXPECT_EQ(mapper.frames_off(), 0u);
  EXPECT_EQ(mapper.flush(), 0u);
}

TEST(SemanticMapper, OlderGraphVersionsAreIgnored) {
  SemanticMapper mapper = mapper_with_tour();
  mapper.update_keyframe_poses(7, tour().keyframes);
  std::mt19937 random(1);
  mapper.update_keyframe_poses(6, corrected(random, 0.2));
  EXPECT_EQ(mapper.flush(), 0u);
  AnchoredFrame late = tour().frames[0];
  late.graph_version = 3;
  late.T_map_keyframe.translation().x() += 1.0;
  mapper.integrate(late);
  EXPECT_TRUE(mapper.frames().back().T_map_camera.isApprox(mapper.frames().front().T_map_camera, 1e-12));
}

TEST(SemanticMapper, FrozenMapNeverMoves) {
  MapperConfig config;
  config.re_anchor = false;
  SemanticMapper mapper = mapper_with_tour(config);
  const mapping::VoxelMap before = mapper.map();
  std::mt19937 random(1);
  mapper.update_keyframe_poses(2, corrected(random, 0.3));
  EXPECT_EQ(mapper.re_anchor(100), 0u);
  EXPECT_EQ(mapper.flush(), 0u);
  EXPECT_EQ(mapper.map(), before);
}

TEST(SemanticMapper, WallOfFortyClassesStandsAfterThreeFramesLookThroughIt) {
  // Three frames see a wall 2 m ahead, three more see one 4 m ahead of the same camera.
  SemanticMapper mapper(MapperConfig{});
  const Pose T = lapis::test::look({0.125, 0.125, 1.1}, 0.0);
  std::string error;
  for (const float depth_m : {2.0f, 2.0f, 2.0f, 4.0f, 4.0f, 4.0f}) {
    const geometry::DepthImage depth(kCamera.width, kCamera.height, depth_m);
    const geometry::LabelImage labels(kCamera.width, kCamera.height, 1);
    mapper.integrate(
        {{}, 1, T, Pose::Identity(), 1, mapping::CompactFrame::make(kCamera, depth, &labels, {1, 40}, error).value()});
  }
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  const mapping::VoxelCounts wall = mapper.map().read(mapper.map().index_of({2.125, 0.125, 1.1}));
  EXPECT_EQ(wall.passes, 3 * mapping::kOneVote);
  EXPECT_TRUE(reader.is_occupied(wall));
  EXPECT_EQ(reader.label(wall), 1);
}

TEST(SemanticMapper, MirrorOfTheTilesEqualsTheMapThroughCorrections) {
  MapperConfig config;
  config.resolution_m = 0.1;
  SemanticMapper mapper(config);
  mapping::MapMirror mirror, late;
  std::mt19937 random(2);
  const auto publish = [&] {
    for (const TileUpdate& tile : mapper.take_changed_tiles())
      EXPECT_EQ(mirror.apply_tile(0, tile.index, tile.version, tile.bytes), mapping::TileResult::kAccepted);
    mirror.apply_state(mapper.state());
    ASSERT_TRUE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), mapper.map());
  };
  for (std::size_t i = 0; i < tour().frames.size(); i += 4) {
    mapper.integrate(tour().frames[i]);
    publish();
  }
  mapper.update_keyframe_poses(2, corrected(random, 0.3));
  while (mapper.re_anchor(1) > 0) publish();
  mapper.flush();
  publish();
  EXPECT_FALSE(mapper.has_changes());
  const std::uint64_t version = mapper.version();
  EXPECT_TRUE(mapper.take_changed_tiles().empty());
  EXPECT_EQ(mapper.version(), version);

  late.apply_state(mapper.state());
  for (const TileUpdate& tile : mapper.all_tiles()) late.apply_tile(0, tile.index, tile.version, tile.bytes);
  ASSERT_TRUE(late.is_consistent());
  EXPECT_EQ(*late.map(), mapper.map());
}

TEST(SemanticMapper, SavedAndLoadedEqualsOriginal) {
  const SemanticMapper mapper = mapper_with_tour();
  std::string error;
  const auto loaded = mapping::decode_map(mapping::encode_map({mapper.map(), {}, {}, {}}), error);
  ASSERT_TRUE(loaded) << error;
  EXPECT_EQ(loaded->map, mapper.map());
}

TEST(SemanticMapper, PosesThatAreNotPosesAreRefused) {
  SemanticMapper mapper(MapperConfig{});
  AnchoredFrame frame = tour().frames[0];
  frame.T_map_keyframe.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mapper.integrate(frame).status, IntegrationStatus::kInvalidPose);
  frame = tour().frames[0];
  frame.T_keyframe_camera.linear() *= 2.0;
  EXPECT_EQ(mapper.integrate(frame).status, IntegrationStatus::kInvalidPose);
  frame = tour().frames[0];
  frame.T_map_keyframe.translation().x() = 1e6;
  EXPECT_EQ(mapper.integrate(frame).status, IntegrationStatus::kTooFarAway);
  EXPECT_EQ(mapper.frames().size(), 0u);
  EXPECT_EQ(mapper.map().block_count(), 0u);

  mapper.integrate(tour().frames[0]);
  std::vector<KeyframePose> bad = {tour().keyframes[0]};
  bad[0].T_map_keyframe.translation().y() = std::numeric_limits<double>::infinity();
  mapper.update_keyframe_poses(9, bad);
  EXPECT_EQ(mapper.flush(), 0u);
}

TEST(SemanticMapper, RefusesConfigurationOutOfRange) {
  MapperConfig config;
  config.resolution_m = 1.0;
  EXPECT_THROW(SemanticMapper{config}, std::runtime_error);
  config = {};
  config.resolution_m = 0.02;
  config.integration.max_range_m = 15.0;
  EXPECT_THROW(SemanticMapper{config}, std::runtime_error);
  config = {};
  config.tile_edge_m = 0.0;
  EXPECT_THROW(SemanticMapper{config}, std::runtime_error);
}

}  // namespace
}  // namespace lapis::semantic_mapper
