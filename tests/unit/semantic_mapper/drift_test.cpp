// Frames at poses by odometry alone: what of them enters the map, what waits, and what a wrong pose may destroy.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "semantic_mapper/core/floor_plan.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;
using mapping::Drift;

const geometry::PinholeCamera kSmallCamera{80, 45, 40, 40, 39.5, 22.0};
constexpr std::size_t kAnyWork = 1'000'000'000;

mapping::CompactFrame frame_at(const std::vector<lapis::test::Box>& room, const Pose& T_map_camera) {
  const auto image = lapis::test::render(room, kSmallCamera, T_map_camera);
  std::string error;
  return mapping::CompactFrame::make(kSmallCamera, image.depth, &image.labels, {1, 40}, error).value();
}

/// Odometry leads from key-frame 1, which vision holds, past key-frames 2 to 4; each has four frames.
class Blind : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kHeld = 1, kLast = 4;

  static Pose true_keyframe(std::uint64_t id) {
    return lapis::test::look({-1.0 + 0.3 * static_cast<double>(id), 0.2, 1.0}, 0.2 * static_cast<double>(id), 0.1);
  }
  /// As odometry has it: the more off, the later.
  static Pose claimed_keyframe(std::uint64_t id) {
    Pose T = true_keyframe(id);
    T.translation() += Eigen::Vector3d(0.12, -0.1, 0.0) * static_cast<double>(id - kHeld);
    return T;
  }
  static Drift drift_at(std::uint64_t id) {
    return {0.04 * static_cast<double>(id - kHeld), 0.01 * static_cast<double>(id - kHeld)};
  }
  static AnchoredFrame frame(std::uint64_t id, int i, const Pose& T_map_keyframe, const Drift& drift) {
    static const auto room = lapis::test::furnished_room();
    const Pose T_keyframe_camera =
        geometry::se3_exp((geometry::Vector6d() << 0.01 * i, 0, 0.02 * i, 0, 0.05 * i, 0).finished());
    return {time::Time{static_cast<std::int64_t>(10 * id) + i},    id,    T_map_keyframe, T_keyframe_camera, 1,
            frame_at(room, true_keyframe(id) * T_keyframe_camera), drift, i == 0};
  }
  static std::vector<KeyframePose> graph(Pose (*pose)(std::uint64_t), bool is_drifting) {
    std::vector<KeyframePose> poses;
    for (std::uint64_t id = kHeld; id <= kLast; ++id) poses.push_back({id, pose(id), is_drifting && id != kHeld});
    return poses;
  }
  static void drive(SemanticMapper& mapper) {
    for (std::uint64_t id = kHeld; id <= kLast; ++id)
      for (int i = 0; i < 4; ++i)
        ASSERT_EQ(mapper.integrate(frame(id, i, claimed_keyframe(id), drift_at(id))).status,
                  IntegrationStatus::kIntegrated);
  }
  /// All frames at true poses that vision holds.
  static mapping::VoxelMap true_map() {
    SemanticMapper mapper(MapperConfig{});
    for (std::uint64_t id = kHeld; id <= kLast; ++id)
      for (int i = 0; i < 4; ++i) mapper.integrate(frame(id, i, true_keyframe(id), {}));
    return mapper.map();
  }
  static mapping::VoxelMap built_from_records(SemanticMapper& mapper) {
    mapping::VoxelMap map(mapper.config().resolution_m);
    for (std::size_t i = 0; i < mapper.frames().size(); ++i) {
      const StoredFrame& stored = mapper.frames()[i];
      map.add(mapping::compute_votes(mapper.stored_frame(i).value(), stored.T_map_camera, mapper.config().integration,
                                     mapper.config().resolution_m, stored.drift));
    }
    return map;
  }
};

TEST_F(Blind, FramesComeInWholeOnceTheirKeyframesAreCorrected) {
  SemanticMapper mapper(MapperConfig{});
  drive(mapper);
  EXPECT_EQ(mapper.frames_waiting(), 12u) << "the key-frames' own frames say that these drift";
  EXPECT_EQ(mapper.map(), built_from_records(mapper));
  mapper.update_keyframe_poses(2, graph(claimed_keyframe, true));
  EXPECT_EQ(mapper.re_anchor(kAnyWork), 0u);
  EXPECT_EQ(mapper.frames_waiting(), 12u);

  mapper.update_keyframe_poses(3, graph(true_keyframe, false));
  for (std::size_t left = 12; left > 0; --left) {
    EXPECT_EQ(mapper.frames_waiting(), left);
    EXPECT_EQ(mapper.re_anchor(1), 1u) << "one by one, if so little work is allowed";
    ASSERT_EQ(mapper.map(), built_from_records(mapper)) << left;
  }
  EXPECT_EQ(mapper.frames_waiting(), 0u);
  EXPECT_TRUE(mapper.provisional_area().cells.empty());
  EXPECT_EQ(mapper.map(), true_map());
  EXPECT_EQ(mapper.flush(), 0u);
}

TEST_F(Blind, ACorrectionThatMovesNothingLetsThemInToo) {
  SemanticMapper mapper(MapperConfig{});
  for (int i = 0; i < 4; ++i) mapper.integrate(frame(2, i, true_keyframe(2), drift_at(2)));
  mapper.update_keyframe_poses(2, graph(true_keyframe, true));
  mapper.update_keyframe_poses(3, graph(true_keyframe, false));
  mapper.update_keyframe_poses(4, graph(true_keyframe, false));
  EXPECT_EQ(mapper.re_anchor(kAnyWork), 4u);
  SemanticMapper expected(MapperConfig{});
  for (int i = 0; i < 4; ++i) expected.integrate(frame(2, i, true_keyframe(2), {}));
  EXPECT_EQ(mapper.map(), expected.map());
}

TEST_F(Blind, WithoutACorrectionTheyStayOutAndFollowTheGraphInPart) {
  SemanticMapper mapper(MapperConfig{});
  drive(mapper);
  mapper.update_keyframe_poses(2, graph(true_keyframe, true));
  EXPECT_GT(mapper.flush(), 0u);
  EXPECT_EQ(mapper.frames_waiting(), 12u);
  mapping::VoxelMap expected(mapper.config().resolution_m);
  for (std::uint64_t id = kHeld; id <= kLast; ++id)
    for (int i = 0; i < 4; ++i) {
      const AnchoredFrame f = frame(id, i, true_keyframe(id), drift_at(id));
      expected.add(mapping::compute_votes(f.frame, f.T_map_keyframe * f.T_keyframe_camera, mapper.config().integration,
                                          mapper.config().resolution_m, f.drift));
    }
  EXPECT_EQ(mapper.map(), expected);
}

TEST_F(Blind, OnAHeldKeyframeNothingCanCorrectThem) {
  SemanticMapper mapper(MapperConfig{});
  for (int i = 0; i < 4; ++i) mapper.integrate(frame(kHeld, i, true_keyframe(kHeld), i == 0 ? Drift{} : drift_at(2)));
  EXPECT_EQ(mapper.frames_waiting(), 0u);
  EXPECT_EQ(mapper.frames_in_part(), 3u);
  mapper.update_keyframe_poses(2, graph(true_keyframe, false));
  EXPECT_EQ(mapper.flush(), 0u);
  EXPECT_EQ(mapper.map(), built_from_records(mapper));
}

TEST_F(Blind, AFrozenMapKeepsNothingForLater) {
  MapperConfig config;
  config.re_anchor = false;
  SemanticMapper mapper(config);
  drive(mapper);
  EXPECT_EQ(mapper.frames_waiting(), 0u);
  EXPECT_EQ(mapper.frames_in_part(), 12u);
  const mapping::VoxelMap before = mapper.map();
  mapper.update_keyframe_poses(2, graph(true_keyframe, false));
  EXPECT_EQ(mapper.flush(), 0u);
  EXPECT_EQ(mapper.map(), before);
}

TEST_F(Blind, FramesThatTheDiskDoesNotTakeDoNotWait) {
  MapperConfig config;
  config.stored_frames = {0, testing::TempDir() + "/no_such_folder"};
  SemanticMapper mapper(config);
  drive(mapper);
  EXPECT_EQ(mapper.frames_waiting(), 0u);
  EXPECT_EQ(mapper.frames_in_part(), 12u);
  const mapping::VoxelMap before = mapper.map();
  mapper.update_keyframe_poses(2, graph(true_keyframe, false));
  EXPECT_EQ(mapper.re_anchor(kAnyWork), 0u);
  EXPECT_EQ(mapper.map(), before);
}

using Place = std::pair<int, int>;

/// Cells of a grid that have a value, as indices of voxels.
std::set<Place> known_cells(const OccupancyGrid& grid) {
  std::set<Place> cells;
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    if (grid.cells[i] == kUnknown) continue;
    const int width = grid.width, at = static_cast<int>(i);
    cells.emplace(std::lround(grid.origin_x_m / grid.resolution_m) + at % width,
                  std::lround(grid.origin_y_m / grid.resolution_m) + at / width);
  }
  return cells;
}

TEST_F(Blind, TheProvisionalAreaIsWhatTheFloorPlanOfTheWaitingFramesWouldKnow) {
  SemanticMapper mapper(MapperConfig{}), whole(MapperConfig{});
  drive(mapper);
  const auto expect_area_at = [&](Pose (*pose)(std::uint64_t)) {
    SemanticMapper held(MapperConfig{});
    for (std::uint64_t id = kHeld + 1; id <= kLast; ++id)
      for (int i = 0; i < 4; ++i) held.integrate(frame(id, i, pose(id), {}));
    FloorPlan plan(held.config().band);
    const OccupancyGrid area = mapper.provisional_area();
    EXPECT_EQ(known_cells(area), known_cells(plan.project(held.map(), mapping::BeliefReader{mapping::SensorModel{}})));
    EXPECT_EQ(std::count(area.cells.begin(), area.cells.end(), kOccupied), 0);
  };
  expect_area_at(claimed_keyframe);
  mapper.update_keyframe_poses(2, graph(true_keyframe, true));
  mapper.flush();
  expect_area_at(true_keyframe);
}

TEST_F(Blind, TheReportHasAllThatTheFrameSees) {
  SemanticMapper mapper(MapperConfig{}), held(MapperConfig{});
  const auto blind = mapper.integrate(frame(3, 0, true_keyframe(3), {1.0, 0.1}));
  EXPECT_EQ(blind.votes, held.integrate(frame(3, 0, true_keyframe(3), {})).votes);
  EXPECT_EQ(mapper.map().block_count(), 0u) << "half a voxel is exceeded everywhere";
}

/// A wall of 8 m, seen by a robot that knows for a second where it is (10 frames), and for 30 s by odometry alone.
class MappedWall : public ::testing::Test {
 protected:
  struct Error {
    double forwards = 0.0;  ///< claimed position, towards the wall (+x) [sigmas]
    double turned = 0.0;    ///< claimed heading [sigmas]
  };
  static constexpr double kRate_hz = 10.0, kSpeed_m_s = 0.3, kTurnRate_rad_s = 0.2;

  /// In front of the wall, to and fro and looking around.
  static Pose at(double s) { return lapis::test::look({1.7, std::sin(0.3 * s), 1.05}, 0.4 * std::sin(0.5 * s)); }
  /// By the noise that slam expects of odometry: slam.odometry.{distance_sigma, turn_sigma, turn_sigma_per_m,
  /// scale_sigma} as they are by default.
  static Drift grown(double s) {
    constexpr double kDistance = 0.02, kTurn = 0.02, kTurnPerMetre = 0.01, kScale = 0.02;
    const double path_m = kSpeed_m_s * s, turned_rad = kTurnRate_rad_s * s;
    const double along = kDistance * kDistance * path_m + std::pow(kScale * path_m, 2);
    const double yaw =
        kTurn * kTurn * turned_rad + kTurnPerMetre * kTurnPerMetre * path_m + std::pow(kScale * turned_rad, 2);
    return {std::sqrt(std::max(along, 0.25 * yaw * path_m * path_m)) + 1e-4, std::sqrt(yaw) + 1e-4};
  }
  std::vector<lapis::test::Box> room() const {
    const double x = wall_m;
    return {{{x, -4, 0}, {x + 0.3, 4, 2.6}, 1},    {{-2, -4.3, 0}, {x, -4, 2.6}, 5}, {{-2, 4, 0}, {x, 4.3, 2.6}, 5},
            {{-2.3, -4, 0}, {-2, 4, 2.6}, 5},      {{-2, -4, -0.3}, {x, 4, 0}, 2},   {{-2, -4, 2.6}, {x, 4, 2.9}, 3},
            {{x - 0.6, 1.0, 0}, {x, 1.8, 1.5}, 11}};
  }
  /// Share of the voxels of wall and cupboard that were occupied before the blind frames and are not after them.
  double erased(const Error& error, Drift (*drift_at)(double s), bool is_told) const {
    MapperConfig config;
    config.re_anchor = false;
    SemanticMapper mapper(config);
    const auto boxes = room();
    for (int i = -10; i < 0; ++i)
      mapper.integrate({{}, 1, at(i / kRate_hz), Pose::Identity(), 1, frame_at(boxes, at(i / kRate_hz))});
    const mapping::BeliefReader reader{mapping::SensorModel{}};
    std::vector<mapping::VoxelIndex> wall;
    mapper.map().for_each_observed([&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts& counts) {
      const int label = reader.is_occupied(counts) ? reader.label(counts) : 0;
      if (label == 1 || label == 11) wall.push_back(voxel);
    });
    EXPECT_GT(wall.size(), 100u);
    for (int i = 0; i < 300; ++i) {
      const double s = i / kRate_hz;
      const Drift drift = drift_at(s);
      Pose claimed = at(s);
      claimed.translation().x() += error.forwards * drift.position_m;
      claimed.linear() =
          Eigen::AngleAxisd(error.turned * drift.rotation_rad, Eigen::Vector3d::UnitZ()) * at(s).linear();
      mapper.integrate({{}, 1, claimed, Pose::Identity(), 1, frame_at(boxes, at(s)), is_told ? drift : Drift{}});
    }
    const auto is_gone = [&](const auto& voxel) { return !reader.is_occupied(mapper.map().read(voxel)); };
    return static_cast<double>(std::count_if(wall.begin(), wall.end(), is_gone)) / static_cast<double>(wall.size());
  }
  static constexpr Error kErrors[] = {{3, 0}, {-3, 0}, {0, 3}, {0, -3}, {3, 3}, {3, -3}, {-3, 3}, {-3, -3}};

  double wall_m = 4.24;  ///< in the last centimetre of a layer of voxels, which is easiest to erase
};

TEST_F(MappedWall, ThirtySecondsOfOdometryWithAnErrorOfThreeSigmasEraseLessThanAHundredthOfIt) {
  for (const double place_m : {4.01, 4.13, 4.24}) {
    wall_m = place_m;
    for (const Error& error : kErrors)
      EXPECT_LT(erased(error, grown, true), 0.01) << place_m << ": " << error.forwards << ", " << error.turned;
  }
}

TEST_F(MappedWall, FramesThatDoNotTellTheirDriftEraseMuchOfIt) { EXPECT_GT(erased({3, 0}, grown, false), 0.3); }

// A robot that waits: the wall stays just within the range at which a frame may be integrated.
TEST_F(MappedWall, ThirtySecondsOfADriftThatStaysDoNotEither) {
  const auto staying = [](double) { return Drift{0.055, 0.0275}; };
  ASSERT_GT(staying(0.0).range_m(0.125), wall_m - 1.7);
  for (const Error& error : kErrors)
    EXPECT_LT(erased(error, staying, true), 0.01) << error.forwards << ", " << error.turned;
  EXPECT_GT(erased({3, 0}, staying, false), 0.3);
}

}  // namespace
}  // namespace lapis::semantic_mapper
