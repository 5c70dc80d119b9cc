// The information of the pose graph beside that of the problem that its measurements make, landmarks eliminated:
// docs/decisions/0025.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "slam/core/frame/noise_model.hpp"
#include "slam/core/mapping/bundle_adjuster.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "slam/core/tracking/tracker.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using Eigen::MatrixXd;
using geometry::Matrix6d;
using geometry::Pose;

constexpr int kSpentTurn = 120,
              kSpentFrames = 170;     // frames of a turn: 3 degrees each; after about 100 the first views return
constexpr double kCalibration = 2.0;  // of all alignments' information: docs/decisions/0025

time::Time spent_stamp(int index) { return time::Time::from_seconds(1.0 + index / 15.0); }
int index_of(time::Time stamp) { return static_cast<int>(std::lround((stamp.seconds() - 1.0) * 15.0)); }

// A camera that turns on the spot and moves about a little, never twice the same way.
Pose spent_turn(int index) {
  const double angle = 2.0 * M_PI * index / kSpentTurn;
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(0.4 * std::sin(angle), 0.001 * index, 0.3 * std::cos(angle));
  T.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  return T;
}

// With depth as noisy as the model says.
RgbdFrame spent_frame(const NoiseConfig& noise, int index) {
  RgbdFrame frame = test::render_room(test::small_camera(), spent_turn(index), spent_stamp(index));
  std::mt19937 random(static_cast<unsigned>(index));
  std::normal_distribution<double> normal;
  for (float& z : frame.depth.pixels) z += static_cast<float>(depth_sigma(noise, z) * normal(random));
  return frame;
}

// A point and all features that show it.
struct Track {
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  std::vector<Observation> observations;
};

// Jacobians of a whitened observation.
struct Sight {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 6> by_pose = Eigen::Matrix<double, 3, 6>::Zero();
  Eigen::Matrix3d by_point = Eigen::Matrix3d::Zero();
};

class SpentOnce : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    config_.surface.enabled = false;  // only landmarks inform
    config_.loop.spacing_m = 0.5;     // the whole path is 3 m: more than one pair
    slam_ = std::make_unique<RgbdSlam>(config_, spent_turn(0));
    for (int i = 0; i < kSpentFrames; ++i)
      ASSERT_EQ(slam_->process(spent_frame(config_.noise, i)).state, TrackingState::kTracking);
    slam_->settle();
  }
  static void TearDownTestSuite() { slam_.reset(); }

  static const Map& map() { return slam_->map(); }
  static Eigen::Index size() { return 6 * std::ssize(map().keyframes()); }
  static std::vector<Track> tracks() {
    std::vector<Track> result;
    for (const Landmark& landmark : map().landmarks()) result.push_back({landmark.p_map, landmark.observations});
    return result;
  }
  static std::vector<Track> tracks_with_loops();

  static Sight sight(const Track& track, const Observation& observation) {
    const Keyframe& keyframe = map().keyframe(observation.keyframe);
    const Feature& feature = keyframe.features[static_cast<std::size_t>(observation.feature)];
    const double sigma = config_.noise.pixel_sigma_px * std::pow(config_.features.scale_factor, feature.octave);
    Sight sight;
    bundle_residual(config_.noise, keyframe.camera, {0, 0, feature.pixel, sigma, feature.depth_m},
                    keyframe.T_map_camera, track.p_map, sight.residual, &sight.by_pose, &sight.by_point);
    return sight;
  }

  static double variance();
  static MatrixXd schur_complement(const std::vector<Track>& tracks);
  static MatrixXd all_pairs(const std::vector<Track>& tracks);
  static MatrixXd graph_information(const std::vector<PoseGraphEdge>& edges);
  static std::vector<PoseGraphEdge> edges(bool with_loops) {
    std::vector<PoseGraphEdge> result = slam_->pose_graph().edges;
    if (!with_loops) std::erase_if(result, [](const auto& edge) { return edge.type == EdgeType::kLoopClosure; });
    return result;
  }

  static inline SlamConfig config_;
  static inline std::unique_ptr<RgbdSlam> slam_;
};

// A loop's alignment takes features of the new key-frame for observations of old landmarks, which the map keeps apart
// from the new key-frame's own: here they are one.
std::vector<Track> SpentOnce::tracks_with_loops() {
  std::vector<Track> result = tracks();
  std::vector<std::size_t> merged(result.size());
  for (std::size_t i = 0; i < merged.size(); ++i) merged[i] = i;
  const auto root = [&](std::size_t i) {
    while (merged[i] != i) i = merged[i];
    return i;
  };
  FeatureExtractor extractor(config_.features);
  const Tracker tracker(config_);
  for (const PoseGraphEdge& edge : edges(true)) {
    if (edge.type != EdgeType::kLoopClosure) continue;
    const RgbdFrame input = spent_frame(config_.noise, index_of(map().keyframe(edge.to).stamp));
    const TrackOutcome outcome = tracker.recognize(map(), make_frame(input, extractor, config_.noise), edge.from,
                                                   map().keyframe(edge.from).T_map_camera * edge.T_from_to);
    EXPECT_TRUE(outcome.is_tracked);
    for (const Match& match : outcome.inliers) {
      const auto feature = static_cast<std::size_t>(match.feature);
      const LandmarkId own = map().keyframe(edge.to).landmarks[feature];
      if (own == kNoLandmark) {
        result[root(match.landmark)].observations.push_back({edge.to, match.feature});
        continue;
      }
      const std::size_t from = root(own), to = root(match.landmark);
      if (from == to) continue;
      merged[from] = to;
      auto& observations = result[to].observations;
      observations.insert(observations.end(), result[from].observations.begin(), result[from].observations.end());
      result[from].observations.clear();
    }
  }
  return result;
}

// Of the unit weight, a posteriori. An alignment's information is divided by its own (pose_refiner); the map's problem
// is the same adjustment of more unknowns.
double SpentOnce::variance() {
  double squares = 0.0;
  Eigen::Index degrees_of_freedom = 6 - size();
  for (const Track& track : tracks()) {
    if (track.observations.size() < 2) continue;
    degrees_of_freedom -= 3;
    for (const Observation& observation : track.observations) {
      const Sight sight = SpentOnce::sight(track, observation);
      squares += sight.residual.squaredNorm();
      degrees_of_freedom += sight.by_point.row(2).isZero() ? 2 : 3;
    }
  }
  return squares / static_cast<double>(degrees_of_freedom);
}

MatrixXd SpentOnce::schur_complement(const std::vector<Track>& tracks) {
  MatrixXd information = MatrixXd::Zero(size(), size());
  for (const Track& track : tracks) {
    std::vector<Sight> sights;
    Eigen::Matrix3d of_point = Eigen::Matrix3d::Zero();
    for (const Observation& observation : track.observations) {
      sights.push_back(sight(track, observation));
      of_point += sights.back().by_point.transpose() * sights.back().by_point;
    }
    const Eigen::Matrix3d inverse = of_point.completeOrthogonalDecomposition().pseudoInverse();
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(track.observations[i].keyframe);
      information.block<6, 6>(row, row) += sights[i].by_pose.transpose() * sights[i].by_pose;
      for (std::size_t j = 0; j < sights.size(); ++j) {
        const auto column = 6 * static_cast<Eigen::Index>(track.observations[j].keyframe);
        information.block<6, 6>(row, column) -= sights[i].by_pose.transpose() * sights[i].by_point * inverse *
                                                sights[j].by_point.transpose() * sights[j].by_pose;
      }
    }
  }
  return kCalibration * information;
}

MatrixXd SpentOnce::graph_information(const std::vector<PoseGraphEdge>& edges) {
  MatrixXd information = MatrixXd::Zero(size(), size());
  for (const PoseGraphEdge& edge : edges) {
    Matrix6d by_from, by_to;
    link_error({0, 0, edge.T_from_to, edge.information}, map().keyframe(edge.from).T_map_camera,
               map().keyframe(edge.to).T_map_camera, &by_from, &by_to);
    const auto from = 6 * static_cast<Eigen::Index>(edge.from), to = 6 * static_cast<Eigen::Index>(edge.to);
    information.block<6, 6>(from, from) += by_from.transpose() * edge.information * by_from;
    information.block<6, 6>(to, to) += by_to.transpose() * edge.information * by_to;
    const Matrix6d cross = by_from.transpose() * edge.information * by_to;
    information.block<6, 6>(from, to) += cross;
    information.block<6, 6>(to, from) += cross.transpose();
  }
  return information;
}

// What the graph must not be: an edge for every pair that shares landmarks, with all that the newer one's features say.
MatrixXd SpentOnce::all_pairs(const std::vector<Track>& tracks) {
  std::map<std::pair<KeyframeId, KeyframeId>, Matrix6d> pairs;
  for (const Track& track : tracks) {
    for (const Observation& newer : track.observations) {
      const Sight sight = SpentOnce::sight(track, newer);
      for (const Observation& older : track.observations) {
        if (older.keyframe >= newer.keyframe) continue;
        const auto entry = pairs.try_emplace({older.keyframe, newer.keyframe}, Matrix6d::Zero()).first;
        entry->second += sight.by_pose.transpose() * sight.by_pose;
      }
    }
  }
  std::vector<PoseGraphEdge> edges;
  for (const auto& [ids, information] : pairs) {
    const Pose T = map().keyframe(ids.first).T_map_camera.inverse() * map().keyframe(ids.second).T_map_camera;
    edges.push_back({ids.first, ids.second, EdgeType::kCovisibility, T, kCalibration * information});
  }
  return graph_information(edges);
}

// Largest ratio of what `graph` claims to what `bound` knows of any motion of the key-frames, the first one fixed.
double largest_ratio(const MatrixXd& graph, const MatrixXd& bound) {
  const Eigen::Index free = graph.rows() - 6;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(
      graph.bottomRightCorner(free, free), bound.bottomRightCorner(free, free), Eigen::EigenvaluesOnly);
  EXPECT_EQ(solver.info(), Eigen::Success);
  return solver.eigenvalues().maxCoeff();
}

TEST_F(SpentOnce, VisualEdgesClaimNoMoreThanTheMapKnows) {
  const double ratio = largest_ratio(graph_information(edges(false)), schur_complement(tracks()) / variance());
  std::cout << "visual edges / Schur complement: at most " << ratio << '\n';
  EXPECT_LE(ratio, 1.0);
}

TEST_F(SpentOnce, NorDoTheyTogetherWithLoops) {
  const auto with_loops = edges(true);
  ASSERT_GE(with_loops.size(), edges(false).size() + 4);
  const double ratio = largest_ratio(graph_information(with_loops), schur_complement(tracks_with_loops()) / variance());
  std::cout << "visual edges and loops / Schur complement: at most " << ratio << '\n';
  EXPECT_LE(ratio, 1.0);
}

TEST_F(SpentOnce, WholeAlignmentsWouldClaimMore) {
  std::vector<PoseGraphEdge> whole = edges(false);
  for (PoseGraphEdge& edge : whole) edge.information *= kCalibration / config_.pose_graph.information_share;
  EXPECT_GT(largest_ratio(graph_information(whole), schur_complement(tracks()) / variance()), 1.5);
}

TEST_F(SpentOnce, EdgesOfAllPairsWouldClaimMore) {
  EXPECT_GT(largest_ratio(all_pairs(tracks()), schur_complement(tracks())), 3.0);
}

}  // namespace
}  // namespace lapis::slam
