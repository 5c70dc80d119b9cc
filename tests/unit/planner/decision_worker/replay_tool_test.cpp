#include "planner/replay_tool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "tests/unit/planner/replay/sample_situation.hpp"

namespace lapis::planner {
namespace {

/// As the planner has it while it runs: with obstacles that came and went, and places on which the robot has stood.
class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() : situation_(test::sample_situation()) {
    situation_.memory.adrift.reset();
    config_.robot.camera.width = 64;
    config_.robot.camera.height = 36;
    config_.view_columns = 16;
    config_.view_rows = 9;
    surroundings_.emplace(completed(config_).surroundings, situation_.map.sensor_model, 0.25);
    surroundings_->update_map(situation_.map.map, situation_.map.map.sorted_blocks());
    const ObstacleGrid grid{{0.5, 0.5}, 0.25, 2, 2, {100, -1, -1, 100}};
    EXPECT_TRUE(surroundings_->update_obstacles(grid, time::Time::from_seconds(1.0)));
    surroundings_->set_blocked(std::vector<Eigen::Vector2d>{{3.4, 1.1}});
    for (double x = 0.5; x < 2.0; x += 0.1) surroundings_->mark_driven({x, 2.0});
    situation_.marks = surroundings_->grid().marks();
  }
  Decision decide_now(const PlannerComponentConfig& config) const {
    const View view(view_config(config));
    DecisionInput input;
    input.surroundings = &*surroundings_;
    input.view = &view;
    input.T_base_camera = geometry::T_base_camera(robot::camera_mount(config.robot.camera));
    input.robot = situation_.robot;
    input.memory = situation_.memory;
    input.config = config.decision;
    input.graph = GraphMessage{1, 1, situation_.graph->keyframes, situation_.graph->edges};
    input.position_variance_m2 = situation_.graph->position_variance_m2;
    input.landmarks = situation_.graph->landmarks;
    return make_decision(std::move(input)).decision;
  }

  RecordedSituation situation_;
  PlannerComponentConfig config_;
  std::optional<Surroundings> surroundings_;
};

TEST_F(ReplayTest, DecidesAsWhenItWasRecorded) {
  for (const char* method : {"lapis", "paper", "ssmi", "tare", "nearest"}) {
    config_.method = method;
    const PlannerComponentConfig config = completed(config_);
    std::string error;
    const auto read = decode_situation(encode_situation(situation_), error);
    ASSERT_TRUE(read) << error;
    const Decision now = decide_now(config), later = decide_again(*read, config);
    ASSERT_TRUE(now.chosen) << method;
    ASSERT_TRUE(later.chosen) << method;
    ASSERT_EQ(now.candidates.size(), later.candidates.size()) << method;
    std::vector<double> of_now, of_later;
    for (const Candidate& c : now.candidates) of_now.push_back(c.utility);
    for (const Candidate& c : later.candidates) of_later.push_back(c.utility);
    std::sort(of_now.begin(), of_now.end());
    std::sort(of_later.begin(), of_later.end());
    EXPECT_EQ(of_now, of_later) << method;
    EXPECT_EQ(now.candidates[*now.chosen].goal.p_map, later.candidates[*later.chosen].goal.p_map) << method;
  }
}

TEST_F(ReplayTest, WithoutAFileThereIsNothingToDo) { EXPECT_FALSE(run_replay(config_)); }

TEST_F(ReplayTest, AFileThatIsNotThereIsNamed) {
  config_.replay = "/nowhere/7.lapis";
  try {
    run_replay(config_);
    FAIL() << "it was read";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/7.lapis"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lapis::planner
