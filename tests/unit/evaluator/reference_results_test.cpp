// The published figures of the TUM RGB-D benchmark's own tools on fr1/xyz (Sturm et al., IROS 2012).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/trajectory/trajectory.hpp"
#include "evaluator/core/trajectory/ate.hpp"
#include "evaluator/core/trajectory/rpe.hpp"
#include "tests/support/test_data.hpp"

namespace lapis::evaluator {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

class ReferenceResults : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = lapis::test::find_test_data("trajectory");
    if (!folder) GTEST_SKIP() << lapis::test::missing_test_data("trajectory");
    std::ifstream(*folder / "reference_results.json") >> document_;
    results_ = document_.front();
    reference_ = trajectory::read_trajectory(*folder / "freiburg1_xyz-groundtruth.txt");
    estimate_ = trajectory::read_trajectory(*folder / "freiburg1_xyz-rgbdslam.txt");
    matches_ = associate(reference_, estimate_, {AssociationRule::kNearest});
  }

  nlohmann::json document_;
  nlohmann::json results_;
  Trajectory reference_;
  Trajectory estimate_;
  std::vector<Match> matches_;
};

TEST_F(ReferenceResults, Association) {
  EXPECT_EQ(reference_.size(), results_["gt_poses"]);
  EXPECT_EQ(estimate_.size(), results_["estimate_poses"]);
  EXPECT_EQ(matches_.size(), results_["matched_pairs"]);
  EXPECT_NEAR(path_length_m(reference_), results_["gt_path_length_m"], 1e-9);
  EXPECT_NEAR(path_length_m(estimate_), results_["estimate_path_length_m"], 1e-9);
}

TEST_F(ReferenceResults, AbsoluteError) {
  const auto error = absolute_error(matches_, Alignment::kSe3);
  const auto& expected = results_["ate_se3"];
  EXPECT_NEAR(error->position_m.rmse, 0.013473, 1e-6);
  EXPECT_NEAR(error->position_m.rmse, expected["rmse"], 1e-9);
  EXPECT_NEAR(error->position_m.mean, expected["mean"], 1e-9);
  EXPECT_NEAR(error->position_m.median, expected["median"], 1e-9);
  EXPECT_NEAR(error->position_m.std, expected["std"], 1e-9);
  EXPECT_NEAR(error->position_m.min, expected["min"], 1e-9);
  EXPECT_NEAR(error->position_m.max, expected["max"], 1e-9);
  for (int row = 0; row < 3; ++row) {
    const auto r = static_cast<std::size_t>(row);
    EXPECT_NEAR(error->T_reference_estimate.translation()[row], expected["translation"][r], 1e-8);
    for (int column = 0; column < 3; ++column) {
      EXPECT_NEAR(error->T_reference_estimate.linear()(row, column),
                  expected["rotation"][r][static_cast<std::size_t>(column)], 1e-8);
    }
  }
  EXPECT_NEAR(absolute_error(matches_, Alignment::kNone)->position_m.rmse, results_["ate_no_alignment_rmse"], 1e-9);
}

TEST_F(ReferenceResults, RelativeErrorOverASecond) {
  const auto error = relative_error(estimate_, matches_, {1.0, DeltaUnit::kSeconds, MotionError::kBenchmark});
  const auto& expected = results_["tum_official_scripts"]["evaluate_rpe.py --fixed_delta --delta 1 --delta_unit s"];
  EXPECT_EQ(error->intervals.size(), expected["compared_pose_pairs"]);
  const auto check = [&](const ErrorStatistics& s, const std::string& name, double factor) {
    EXPECT_NEAR(s.rmse * factor, expected[name + ".rmse"], 1e-6);
    EXPECT_NEAR(s.mean * factor, expected[name + ".mean"], 1e-6);
    EXPECT_NEAR(s.median * factor, expected[name + ".median"], 1e-6);
    EXPECT_NEAR(s.std * factor, expected[name + ".std"], 1e-6);
    EXPECT_NEAR(s.min * factor, expected[name + ".min"], 1e-6);
    EXPECT_NEAR(s.max * factor, expected[name + ".max"], 1e-6);
  };
  check(error->translation_m, "translational_error", 1.0);
  check(error->rotation_rad, "rotational_error", kDegrees);
}

TEST_F(ReferenceResults, RelativeErrorOverFrames) {
  for (const double delta : {1.0, 30.0}) {
    const auto& expected = results_["rpe_delta_" + std::to_string(static_cast<int>(delta)) + "_matched_pairs_all"];
    const auto error = relative_error(estimate_, matches_, {delta, DeltaUnit::kFrames, MotionError::kPaper});
    EXPECT_EQ(error->intervals.size(), expected["pairs"]);
    EXPECT_NEAR(error->translation_m.rmse, expected["trans_rmse_m"], 1e-9);
    EXPECT_NEAR(error->translation_m.mean, expected["trans_mean_m"], 1e-9);
    EXPECT_NEAR(error->translation_m.max, expected["trans_max_m"], 1e-9);
    EXPECT_NEAR(error->rotation_rad.rmse * kDegrees, expected["rot_rmse_deg"], 1e-9);
  }
}

// Umeyama's worked example is planar and scaled; lifted to 3-D it has the same least-squares rotation (a turn about z).
TEST_F(ReferenceResults, UmeyamaRotation) {
  const auto& example = document_["umeyama_1991_example"];
  std::vector<Eigen::Vector3d> x, y;
  for (std::size_t i = 0; i < 3; ++i) {
    x.emplace_back(example["x"][i][0].get<double>(), example["x"][i][1].get<double>(), 0.0);
    y.emplace_back(example["y"][i][0].get<double>(), example["y"][i][1].get<double>(), 0.0);
    // Points out of the plane, so that the mirror image is not reached by turning over.
    x.emplace_back(x.back() + Eigen::Vector3d(0, 0, 100));
    y.emplace_back(y.back() + Eigen::Vector3d(0, 0, 100));
  }
  const geometry::Pose T = align_points(y, x);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      EXPECT_NEAR(T.linear()(row, column),
                  example["R_precise"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)], 1e-9);
    }
  }
}

}  // namespace
}  // namespace lapis::evaluator
