#include "semantic_mapper/core/semantic_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "common/mapping/file/map_file.hpp"
#include "tests/support/full_disk.hpp"
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

/// What the map has to be: the one that it began with, and the stored frames at their recorded poses.
mapping::VoxelMap built_from_records(SemanticMapper& mapper, mapping::VoxelMap map) {
  const MapperConfig& config = mapper.config();
  for (std::size_t i = 0; i < mapper.frames().size(); ++i)
    map.add(mapping::compute_votes(mapper.stored_frame(i).value(), mapper.frames()[i].T_map_camera, config.integration,
                                   config.resolution_m));
  return map;
}

mapping::VoxelMap built_from_records(SemanticMapper& mapper) {
  return built_from_records(mapper, mapping::VoxelMap(mapper.config().resolution_m));
}

constexpr std::size_t kAllWork = 1'000'000'000;

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

/// The tour with random corrections on the way; returns the last key-frame poses. The map must equal a build from the
/// records at any time.
std::vector<KeyframePose> drive_with_corrections(SemanticMapper& mapper, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<KeyframePose> last = tour().keyframes;
  std::uint64_t version = 1;
  for (std::size_t i = 0; i < tour().frames.size(); ++i) {
    AnchoredFrame frame = tour().frames[i];
    frame.graph_version = version;
    const auto is_its = [&frame](const KeyframePose& k) { return k.id == frame.keyframe_id; };
    frame.T_map_keyframe = std::find_if(last.begin(), last.end(), is_its)->T_map_keyframe;
    mapper.integrate(frame);
    if (i % 7 == seed % 7) mapper.update_keyframe_poses(++version, last = corrected(random, 0.05));
    mapper.re_anchor(10'000);
    if ((i + seed) % 13 == 0) {
      EXPECT_EQ(mapper.map(), built_from_records(mapper)) << "after frame " << i;
    }
  }
  mapper.update_keyframe_poses(++version, last = corrected(random, 0.05));
  return last;
}

/// Voxels with hits, and those with misses.
std::pair<std::set<mapping::VoxelIndex>, std::set<mapping::VoxelIndex>> seen_voxels(const mapping::FrameVotes& votes) {
  std::pair<std::set<mapping::VoxelIndex>, std::set<mapping::VoxelIndex>> seen;
  for (const mapping::BlockVotes& block : votes.blocks) {
    for (const mapping::HitVote& hit : votes.hits_of(block)) seen.first.insert(voxel_at(block.block, hit.offset));
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      const auto i = static_cast<std::size_t>(offset);
      if (block.misses[i / 64] >> i % 64 & 1) seen.second.insert(voxel_at(block.block, offset));
    }
  }
  return seen;
}

// Obstacles are taken from frames whose labels are still to come.
TEST(SemanticMapper, ALookAtAFrameWithoutLabelsSeesWhatItsVotesWillBe) {
  std::mt19937 random(5);
  for (const double kernel_length_voxels : {0.0, 2.0}) {
    MapperConfig config;
    config.resolution_m = 0.1;
    config.integration.kernel_length_voxels = kernel_length_voxels;
    config.integration.depth_noise_per_m = 0.02;  // hits of far surfaces weigh little
    SemanticMapper mapper(config);
    std::uint64_t version = 1;
    for (std::size_t i = 0; i < tour().frames.size(); i += 3) {
      if (i % 2 == 1) mapper.update_keyframe_poses(++version, corrected(random, 0.05));
      AnchoredFrame bare = tour().frames[i];
      const auto image =
          lapis::test::render(lapis::test::furnished_room(), kCamera, bare.T_map_keyframe * bare.T_keyframe_camera);
      geometry::ConfidenceImage confidence(kCamera.width, kCamera.height);
      for (std::uint8_t& c : confidence.pixels) c = static_cast<std::uint8_t>(random() % 256);
      std::string error;
      AnchoredFrame labelled = bare;
      bare.frame = mapping::CompactFrame::make(kCamera, image.depth, nullptr, {1, 40}, error).value();
      labelled.frame =
          mapping::CompactFrame::make(kCamera, image.depth, &image.labels, {1, 40}, error, &confidence).value();
      const mapping::VoxelMap before = mapper.map();
      const auto looked = mapper.look(bare);
      EXPECT_EQ(mapper.map(), before);
      const auto report = mapper.integrate(labelled);
      EXPECT_EQ(looked.status, IntegrationStatus::kIntegrated);
      EXPECT_EQ(seen_voxels(looked.votes), seen_voxels(report.votes));
      EXPECT_NE(looked.votes, report.votes) << "labels count in the map";
    }
  }
}

TEST(SemanticMapper, ALookRefusesWhatIntegrationRefuses) {
  SemanticMapper mapper(MapperConfig{});
  AnchoredFrame frame = tour().frames[0];
  frame.T_keyframe_camera.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mapper.look(frame).status, IntegrationStatus::kInvalidPose);
  frame.T_keyframe_camera.translation().x() = 20'000.0;
  EXPECT_EQ(mapper.look(frame).status, IntegrationStatus::kTooFarAway);
}

TEST(SemanticMapper, EqualsBuildFromRecordsAtEveryInstantAndFromScratchAfterFlush) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    MapperConfig config;
    config.resolution_m = seed % 4 == 3 ? 0.1 : 0.25;
    config.stored_frames.memory_mb = seed % 3 == 0 ? 0 : 100;
    config.stored_frames.spill_dir = testing::TempDir();
    if (seed % 5 == 0) config.stakes_model.emplace();
    SemanticMapper mapper(config);
    const std::vector<KeyframePose> last = drive_with_corrections(mapper, seed);
    EXPECT_GT(mapper.flush(), 0u);
    ASSERT_EQ(mapper.map(), built_from_records(mapper)) << seed;
    EXPECT_EQ(mapper.frames_off(), 0u);
    EXPECT_EQ(mapper.store().disk_bytes() > 0, config.stored_frames.memory_mb == 0);
    EXPECT_EQ(mapper.store().let_go(), 0u);

    SemanticMapper scratch(config);
    for (AnchoredFrame frame : tour().frames) {
      for (const KeyframePose& k : last)
        if (k.id == frame.keyframe_id) frame.T_map_keyframe = k.T_map_keyframe;
      scratch.integrate(frame);
    }
    ASSERT_EQ(mapper.map(), scratch.map()) << seed;
    EXPECT_EQ(mapper.flush(), 0u);
    ASSERT_EQ(mapper.stakes() != nullptr, config.stakes_model.has_value());
    if (!config.stakes_model) continue;
    EXPECT_GT(mapper.stakes()->stakes().size(), 4u);
    EXPECT_EQ(mapper.stakes()->stakes(), scratch.stakes()->stakes()) << seed;
  }
}

TEST(SemanticMapper, FramesThatTheDiskDoesNotTakeStayWhereTheyAreAndMappingContinues) {
  MapperConfig config;
  config.stored_frames = {0, testing::TempDir() + "/no_such_folder"};
  SemanticMapper mapper = mapper_with_tour(config);
  EXPECT_EQ(mapper.store().let_go(), tour().frames.size());
  EXPECT_NE(mapper.store().problem().find("no_such_folder"), std::string::npos);
  EXPECT_EQ(mapper.store().memory_bytes(), 0u);
  const mapping::VoxelMap before = mapper.map();
  EXPECT_EQ(before, mapper_with_tour().map());
  std::mt19937 random(1);
  mapper.update_keyframe_poses(2, corrected(random, 0.3));
  EXPECT_EQ(mapper.re_anchor(kAllWork), 0u);
  EXPECT_EQ(mapper.frames_off(), 0u);
  EXPECT_EQ(mapper.flush(), 0u);
  EXPECT_EQ(mapper.map(), before);
}

TEST(SemanticMapper, DiskThatFillsUpLetsFramesGoAndMapsOn) {
  MapperConfig config;
  config.stored_frames = {0, testing::TempDir()};
  const lapis::test::FullDisk disk(150'000);
  SemanticMapper mapper = mapper_with_tour(config);
  const std::size_t lost = mapper.store().let_go();
  EXPECT_GT(lost, 0u);
  EXPECT_LT(lost, tour().frames.size());
  EXPECT_FALSE(mapper.store().problem().empty());
  EXPECT_EQ(mapper.map(), mapper_with_tour().map());
  std::mt19937 random(1);
  mapper.update_keyframe_poses(2, corrected(random, 0.3));
  EXPECT_LE(mapper.flush(), tour().frames.size() - lost);
  mapping::VoxelMap expected = mapper_with_tour().map();
  for (std::size_t i = 0; i < mapper.frames().size(); ++i) {
    const auto votes_at = [&](const Pose& T) {
      return mapping::compute_votes(tour().frames[i].frame, T, config.integration, config.resolution_m);
    };
    expected.subtract(votes_at(tour().frames[i].T_map_keyframe * tour().frames[i].T_keyframe_camera));
    expected.add(votes_at(mapper.frames()[i].T_map_camera));
  }
  EXPECT_EQ(mapper.map(), expected);
}

TEST(SemanticMapper, NearestFramesMoveFirst) {
  SemanticMapper mapper = mapper_with_tour();
  std::mt19937 random(4);
  mapper.update_keyframe_poses(2, corrected(random, 0.2));
  EXPECT_EQ(mapper.frames_off(), tour().frames.size());
  const Eigen::Vector3d robot = mapper.frames().back().T_map_camera.translation();
  const std::vector<StoredFrame> before = mapper.frames();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(mapper.re_anchor(1), 1u);
  const std::vector<StoredFrame> after = mapper.frames();
  mapper.flush();
  double farthest_moved_m = 0.0, nearest_left_m = 1e9;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool was_moved = after[i].T_map_camera.matrix() != before[i].T_map_camera.matrix();
    const double distance_m = (mapper.frames()[i].T_map_camera.translation() - robot).norm();
    double& bound_m = was_moved ? farthest_moved_m : nearest_left_m;
    bound_m = was_moved ? std::max(bound_m, distance_m) : std::min(bound_m, distance_m);
  }
  EXPECT_LE(farthest_moved_m, nearest_left_m);
}

TEST(SemanticMapper, CorrectionsOfLessThanAVoxelNeverCostMoreThanNewFrames) {
  MapperConfig config;
  SemanticMapper mapper = mapper_with_tour(config);
  std::size_t integrated = 0, moved = 0;
  for (const StoredFrame& frame : mapper.frames()) integrated += frame.work;
  const auto shifted = [](std::size_t step, double size_m) {
    std::vector<KeyframePose> poses = tour().keyframes;
    for (KeyframePose& pose : poses) pose.T_map_keyframe.translation().x() += step % 2 == 0 ? size_m : 0.0;
    return poses;
  };
  for (std::size_t step = 0; step < 10; ++step) {
    mapper.update_keyframe_poses(2 + step, shifted(step, 0.1));
    for (std::size_t frames = mapper.re_anchor(kAllWork); frames > 0; --frames) moved += mapper.frames()[0].work;
  }
  EXPECT_GT(mapper.frames_off(), 0u);
  EXPECT_LT(moved, 3 * integrated / 2);  // frames differ in work
  mapper.update_keyframe_poses(100, shifted(0, 0.6));
  EXPECT_EQ(mapper.re_anchor(kAllWork), tour().frames.size());  // larger ones do not wait
  EXPECT_EQ(mapper.frames_off(), 0u);
}

TEST(SemanticMapper, OnlyTilesThatReallyChangeAreSentAgain) {
  MapperConfig config;
  config.resolution_m = 0.25;
  SemanticMapper mapper = mapper_with_tour(config);
  mapper.take_changed_tiles();
  std::vector<KeyframePose> poses = tour().keyframes;
  poses[2].T_map_keyframe.translation().x() += 0.06;
  mapper.update_keyframe_poses(2, poses);
  const mapping::VoxelMap before = mapper.map();
  EXPECT_EQ(mapper.re_anchor(kAllWork), 5u);
  std::set<mapping::TileIndex> changed;
  const int edge = mapping::blocks_per_tile_edge(config.resolution_m, config.tile_edge_m);
  for (const mapping::VoxelMap* map : {&before, &mapper.map()})
    map->for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
      const mapping::VoxelMap& other = map == &before ? mapper.map() : before;
      if (!(other.read(voxel) == counts)) changed.insert(mapping::tile_of(mapping::block_of(voxel), edge));
    });
  const std::vector<TileUpdate> sent = mapper.take_changed_tiles();
  for (const TileUpdate& tile : sent) changed.erase(tile.index);
  EXPECT_TRUE(changed.empty());
  EXPECT_LT(sent.size(), mapper.all_tiles().size());
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
  EXPECT_EQ(mapper.re_anchor(1), 1u);
  EXPECT_EQ(mapper.frames_off(), 4u);
  EXPECT_EQ(mapper.re_anchor(mapper.frames()[10].work * 3 / 2), 2u);
  EXPECT_EQ(mapper.frames_off(), 2u);
  EXPECT_EQ(mapper.re_anchor(kAllWork), 2u);
  EXPECT_EQ(mapper.re_anchor(kAllWork), 0u);
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

/// The tour's key-frames from `begin` to before `end`, moved, and a newer one.
std::vector<KeyframePose> part_of_graph(std::size_t begin, std::size_t end, const Pose& moved) {
  std::vector<KeyframePose> poses(tour().keyframes.begin() + static_cast<std::ptrdiff_t>(begin),
                                  tour().keyframes.begin() + static_cast<std::ptrdiff_t>(end));
  for (KeyframePose& pose : poses) pose.T_map_keyframe = moved * pose.T_map_keyframe;
  poses.push_back({1'000'100, Pose::Identity()});
  return poses;
}

/// After flush(), the frames of the tour's key-frames from `begin` to before `end` are off their first places by that.
void expect_moved(SemanticMapper& mapper, std::size_t begin, std::size_t end, const Pose& moved) {
  mapper.flush();
  EXPECT_EQ(mapper.map(), built_from_records(mapper));
  for (std::size_t i = 5 * begin; i < 5 * end; ++i) {
    const Pose first = tour().frames[i].T_map_keyframe * tour().frames[i].T_keyframe_camera;
    EXPECT_TRUE(mapper.frames()[i].T_map_camera.isApprox(moved * first, 1e-12)) << "frame " << i;
  }
}

const Pose kStep(Eigen::Translation3d(0.4, -0.3, 0.1) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));

TEST(SemanticMapper, KeyframesThatTheGraphHasLostFollowTheNewestOlderOne) {
  SemanticMapper mapper = mapper_with_tour();
  mapper.update_keyframe_poses(2, part_of_graph(0, 4, kStep));
  expect_moved(mapper, 0, 8, kStep);
  std::vector<KeyframePose> poses = part_of_graph(0, 4, kStep);
  poses[3].T_map_keyframe = kStep * poses[3].T_map_keyframe;
  mapper.update_keyframe_poses(3, poses);
  expect_moved(mapper, 0, 3, kStep);
  expect_moved(mapper, 3, 8, kStep * kStep);
  mapper.update_keyframe_poses(2, part_of_graph(0, 2, Pose::Identity()));
  expect_moved(mapper, 3, 8, kStep * kStep);
}

TEST(SemanticMapper, KeyframesThatTheGraphDoesNotListYetOrHasNothingBeforeStayWhereTheyAre) {
  SemanticMapper mapper({});
  for (AnchoredFrame frame : tour().frames) {
    frame.graph_version = frame.keyframe_id < tour().keyframes[4].id ? 1 : 3;
    ASSERT_EQ(mapper.integrate(std::move(frame)).status, IntegrationStatus::kIntegrated);
  }
  mapper.update_keyframe_poses(2, part_of_graph(0, 4, kStep));
  expect_moved(mapper, 0, 4, kStep);
  expect_moved(mapper, 4, 8, Pose::Identity());
  SemanticMapper without_older = mapper_with_tour();
  without_older.update_keyframe_poses(2, part_of_graph(6, 8, kStep));
  expect_moved(without_older, 0, 6, Pose::Identity());
  expect_moved(without_older, 6, 8, kStep);
}

// slam has resumed an older save: its graph corrects the anchor before slam has added a key-frame.
TEST(SemanticMapper, KeyframesThatTheGraphHasLostAreFoundBeforeThereIsANewerOne) {
  SemanticMapper mapper = mapper_with_tour();
  std::vector<KeyframePose> resumed = part_of_graph(0, 4, kStep);
  resumed.pop_back();
  mapper.update_keyframe_poses(1'000'002, resumed);
  expect_moved(mapper, 0, 8, kStep);
}

TEST(SemanticMapper, KeyframesThatAreListedAgainHaveTheirOwnPoses) {
  SemanticMapper mapper = mapper_with_tour();
  mapper.update_keyframe_poses(2, part_of_graph(0, 4, kStep));
  std::vector<KeyframePose> poses = part_of_graph(0, 5, Pose::Identity());
  mapper.update_keyframe_poses(3, poses);
  expect_moved(mapper, 0, 8, Pose::Identity());
  poses[3].T_map_keyframe = kStep * poses[3].T_map_keyframe;
  mapper.update_keyframe_poses(4, poses);
  expect_moved(mapper, 3, 4, kStep);
  expect_moved(mapper, 4, 5, Pose::Identity());
  expect_moved(mapper, 5, 8, kStep);
}

TEST(SemanticMapper, KeyframesFollowOneThatIsLostAsWell) {
  SemanticMapper mapper = mapper_with_tour();
  mapper.update_keyframe_poses(2, part_of_graph(0, 4, Pose::Identity()));
  mapper.update_keyframe_poses(3, part_of_graph(0, 2, Pose::Identity()));
  expect_moved(mapper, 0, 8, Pose::Identity());
  mapper.update_keyframe_poses(4, part_of_graph(0, 2, kStep));
  expect_moved(mapper, 0, 8, kStep);
}

// Slam and the mapper die together. Before, a loop closure had moved all key-frames; the older ones had no frame since.
TEST(SemanticMapper, KeyframesThatTheGraphHasLostFollowInARestoredMapperAsInTheOneBefore) {
  SemanticMapper before({}), restored({});
  std::vector<KeyframePose> closed = tour().keyframes;
  for (KeyframePose& pose : closed) pose.T_map_keyframe = kStep * pose.T_map_keyframe;
  for (std::size_t i = 0; i < tour().frames.size(); ++i) {
    AnchoredFrame frame = tour().frames[i];
    const bool is_late = i >= 35;  // those of the last key-frame
    frame.graph_version = is_late ? 9 : 1;
    if (is_late) frame.T_map_keyframe = kStep * frame.T_map_keyframe;
    if (i == 35) before.update_keyframe_poses(8, std::span(closed).first(7));
    const mapping::CompactFrame samples = frame.frame;
    ASSERT_EQ(before.integrate(std::move(frame)).status, IntegrationStatus::kIntegrated);
    ASSERT_TRUE(restored.restore(*before.newest_record(), samples));
  }
  restored.update_keyframe_poses(8, std::span(closed).first(7));  // does not have the newest key-frame yet
  restored.flush();
  before.flush();
  EXPECT_EQ(restored.map(), before.map());
  for (SemanticMapper* mapper : {&before, &restored})
    mapper->update_keyframe_poses(1'000'008, std::span(closed).first(7));
  restored.flush();
  EXPECT_EQ(restored.map(), before.map()) << "what lies between the lost key-frame and the one before is as it was";
  expect_moved(restored, 0, 8, kStep);
}

TEST(SemanticMapper, FrozenMapNeverMovesAndStoresNoFrames) {
  MapperConfig config;
  config.re_anchor = false;
  config.stored_frames = {0, testing::TempDir() + "/no_such_folder"};
  SemanticMapper mapper = mapper_with_tour(config);
  EXPECT_EQ(mapper.frames_integrated(), tour().frames.size());
  EXPECT_EQ(mapper.frame_bytes(), 0u);
  EXPECT_EQ(mapper.store().let_go(), 0u) << "nothing was meant for the disk";
  const mapping::VoxelMap before = mapper.map();
  EXPECT_EQ(before, mapper_with_tour().map());
  std::mt19937 random(1);
  mapper.update_keyframe_poses(2, corrected(random, 0.3));
  EXPECT_EQ(mapper.re_anchor(kAllWork), 0u);
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
  EXPECT_EQ(wall.misses, 3 * mapping::kOneVote);
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

TEST(SemanticMapper, ALargeMapIsPublishedInLargerTilesAsOneOfANewEpoch) {
  MapperConfig config;
  config.resolution_m = 0.1;  // a block is a tile of 0.8 m
  mapping::VoxelMap base(0.1);
  const auto grow = [&base](std::int32_t from, std::int32_t to) {
    for (std::int32_t i = from; i < to; ++i) base.set_block({i % 50 - 20, i / 50, 1}, mapping::VoxelBlock(256));
  };
  grow(0, 2000);
  SemanticMapper small(config, base);
  EXPECT_FALSE(small.enlarge_tiles()) << "1,000 m3";
  grow(2000, 2001);
  SemanticMapper mapper(config, base);
  mapping::MapMirror mirror;
  const auto publish = [&](std::int64_t epoch) {
    for (const TileUpdate& tile : mapper.take_changed_tiles())
      EXPECT_EQ(mirror.apply_tile(epoch, tile.index, tile.version, tile.bytes), mapping::TileResult::kAccepted);
    mapping::MapState state = mapper.state();
    state.epoch = epoch;
    mirror.apply_state(state);
    ASSERT_TRUE(mirror.is_consistent());
    EXPECT_EQ(*mirror.map(), mapper.map());
  };
  publish(1);
  EXPECT_EQ(mirror.state()->tiles, 2001u);
  EXPECT_DOUBLE_EQ(mapper.tile_edge_m(), 0.8);
  ASSERT_TRUE(mapper.enlarge_tiles());
  EXPECT_DOUBLE_EQ(mapper.tile_edge_m(), 1.6);
  EXPECT_TRUE(mapper.has_changes());
  publish(2);
  EXPECT_EQ(mirror.state()->tiles, 25u * 20u + 1u);
  EXPECT_FALSE(mapper.enlarge_tiles());
  mapper.integrate(tour().frames[0]);
  publish(2);
}

TEST(SemanticMapper, TilesAreNotEnlargedBeyondWhatASampleHolds) {
  MapperConfig config;
  config.resolution_m = 0.02;  // 5 blocks of 0.16 m make a tile
  mapping::VoxelMap base(0.02);
  for (std::int32_t i = 0; i < 2500; ++i) base.set_block({5 * i, 0, 0}, mapping::VoxelBlock(256));
  SemanticMapper mapper(config, base);
  EXPECT_FALSE(mapper.enlarge_tiles());
  EXPECT_EQ(mapper.take_changed_tiles().size(), 2500u);
}

TEST(SemanticMapper, SavedAndLoadedEqualsOriginal) {
  const SemanticMapper mapper = mapper_with_tour();
  std::string error;
  const auto loaded = mapping::decode_map(mapping::encode_map({mapper.map(), {}, {}, {}}), error);
  ASSERT_TRUE(loaded) << error;
  EXPECT_EQ(loaded->map, mapper.map());
}

// A run that was saved and resumed: old counts stay, new frames are added, and only these follow the graph.
TEST(SemanticMapper, ResumedEqualsTheSavedMapPlusTheNewFrames) {
  const SemanticMapper first = mapper_with_tour();
  std::string error;
  const auto saved = mapping::decode_map(mapping::encode_map({first.map(), {}, {}, {}}), error);
  ASSERT_TRUE(saved) << error;
  SemanticMapper second(MapperConfig{}, saved->map);
  EXPECT_EQ(second.map(), first.map());
  for (const AnchoredFrame& frame : tour().frames) second.integrate(frame);
  std::mt19937 random(5);
  second.update_keyframe_poses(2, corrected(random, 0.1));
  EXPECT_GT(second.flush(), 0u);
  EXPECT_EQ(second.map(), built_from_records(second, saved->map));
}

TEST(SemanticMapper, ResumedPublishesTheWholeMap) {
  const SemanticMapper first = mapper_with_tour();
  SemanticMapper second(MapperConfig{}, first.map());
  mapping::MapMirror mirror;
  for (const TileUpdate& tile : second.take_changed_tiles()) mirror.apply_tile(0, tile.index, tile.version, tile.bytes);
  mirror.apply_state(second.state());
  ASSERT_TRUE(mirror.is_consistent());
  EXPECT_EQ(*mirror.map(), first.map());
}

TEST(SemanticMapper, AFullMapTakesNoMoreFrames) {
  mapping::VoxelMap full(0.25);
  mapping::VoxelBlock block;
  block.add_miss(0, 0xffffff00u);
  full.set_block({0, 0, 0}, block);
  SemanticMapper mapper(MapperConfig{}, full);
  EXPECT_EQ(mapper.integrate(tour().frames[0]).status, IntegrationStatus::kMapIsFull);
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
  EXPECT_THROW(SemanticMapper(MapperConfig{}, mapping::VoxelMap(0.1)), std::runtime_error);
}

}  // namespace
}  // namespace lapis::semantic_mapper
