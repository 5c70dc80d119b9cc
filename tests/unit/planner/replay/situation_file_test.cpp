#include "planner/core/replay/situation_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <tuple>

#include "tests/unit/planner/replay/sample_situation.hpp"

namespace lapis::planner {
namespace {

using ::testing::HasSubstr;

TEST(SituationFile, ComesBackAsItWas) {
  const RecordedSituation situation = test::sample_situation();
  const auto bytes = encode_situation(situation);
  std::string error;
  const auto again = decode_situation(bytes, error);
  ASSERT_TRUE(again) << error;
  EXPECT_EQ(encode_situation(*again), bytes);
  EXPECT_EQ(again->map.map, situation.map.map);
  EXPECT_EQ(again->map.provenance, situation.map.provenance);
  EXPECT_EQ(again->marks, situation.marks);
  EXPECT_EQ(again->robot, situation.robot);
  EXPECT_EQ(again->memory, situation.memory);
  ASSERT_EQ(again->graph->keyframes.size(), situation.graph->keyframes.size());
  for (std::size_t i = 0; i < situation.graph->keyframes.size(); ++i) {
    EXPECT_EQ(again->graph->keyframes[i].id, situation.graph->keyframes[i].id);
    EXPECT_EQ(again->graph->keyframes[i].T_map_camera.matrix(), situation.graph->keyframes[i].T_map_camera.matrix());
  }
  ASSERT_EQ(again->graph->edges.size(), situation.graph->edges.size());
  for (std::size_t i = 0; i < situation.graph->edges.size(); ++i) {
    const KeyframeEdge &read = again->graph->edges[i], &written = situation.graph->edges[i];
    EXPECT_EQ(std::tie(read.from, read.to, read.is_loop_closure),
              std::tie(written.from, written.to, written.is_loop_closure));
    EXPECT_EQ(read.information, written.information);
  }
  EXPECT_EQ(again->graph->position_variance_m2, situation.graph->position_variance_m2);
  EXPECT_EQ(again->graph->landmarks, situation.graph->landmarks);
}

TEST(SituationFile, WithoutAGraphAndAnythingToRemember) {
  RecordedSituation situation = test::sample_situation();
  situation.graph.reset();
  situation.memory = {};
  const auto bytes = encode_situation(situation);
  std::string error;
  const auto again = decode_situation(bytes, error);
  ASSERT_TRUE(again) << error;
  EXPECT_FALSE(again->graph);
  EXPECT_FALSE(again->memory.goal);
  EXPECT_EQ(encode_situation(*again), bytes);
}

TEST(SituationFile, IsRefusedWhenCutOrSpoilt) {
  const auto bytes = encode_situation(test::sample_situation());
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    std::string error;
    EXPECT_FALSE(decode_situation(std::span(bytes).first(size), error)) << size;
    EXPECT_FALSE(error.empty()) << size;
  }
  for (std::size_t at = 0; at < bytes.size(); at += 5) {
    auto spoilt = bytes;
    spoilt[at] ^= 0x10;
    std::string error;
    EXPECT_FALSE(decode_situation(spoilt, error)) << at;
    EXPECT_FALSE(error.empty()) << at;
  }
}

TEST(SituationFile, ValuesThatMakeNoSenseAreRefused) {
  const auto refusal = [](const auto& spoil) {
    RecordedSituation situation = test::sample_situation();
    spoil(situation);
    std::string error;
    return decode_situation(encode_situation(situation), error) ? "accepted" : error;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](auto& s) { s.robot.yaw_rad = kNan; }), HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.robot.p_map.x() = 1e7; }), HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.marks.driven[0].x = 1 << 30; }), HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.memory.left_alone[0].reason = static_cast<Rejection>(99); }),
              HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.graph->keyframes[0].T_map_camera.linear() *= 2.0; }),
              HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.graph->edges[0].information(0, 0) = kNan; }), HasSubstr("makes no sense"));
  EXPECT_THAT(refusal([](auto& s) { s.graph->landmarks.begin()->second.observers.pop_back(); }),
              HasSubstr("makes no sense"));
  EXPECT_EQ(refusal([](auto&) {}), "accepted");
}

}  // namespace
}  // namespace lapis::planner
