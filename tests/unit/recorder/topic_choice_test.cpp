#include <gtest/gtest.h>

#include "recorder/core/topic_choice.hpp"

namespace lapis::recorder {
namespace {

TEST(TopicPattern, StandsForAnyTextWhereItHasAStar) {
  EXPECT_TRUE(matches("/tf", "/tf"));
  EXPECT_FALSE(matches("/tf", "/tf_static"));
  EXPECT_FALSE(matches("/tf_static", "/tf"));
  EXPECT_TRUE(matches("/tf*", "/tf"));
  EXPECT_TRUE(matches("/tf*", "/tf_static"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("/camera/*/camera_info", "/camera/depth/camera_info"));
  EXPECT_FALSE(matches("/camera/*/camera_info", "/camera/depth/image_raw"));
  EXPECT_TRUE(matches("*a*b", "xaxbab"));  // the first b is not the last
  EXPECT_FALSE(matches("*a*b", "xaxbabc"));
  EXPECT_TRUE(matches("**", "/x"));
  EXPECT_FALSE(matches("", "/x"));
}

TEST(TopicChoice, TakesAllButTheUnwantedUnlessSomeAreNamed) {
  const TopicChoice all{{}, {}}, some{{"/camera/*", "/tf"}, {"*/compressed"}}, most{{}, {"/camera/*"}};
  EXPECT_TRUE(all.includes("/any"));
  EXPECT_TRUE(some.includes("/camera/color/image_raw"));
  EXPECT_TRUE(some.includes("/tf"));
  EXPECT_FALSE(some.includes("/odom"));
  EXPECT_FALSE(some.includes("/camera/color/image_raw/compressed"));
  EXPECT_TRUE(most.includes("/odom"));
  EXPECT_FALSE(most.includes("/camera/color/image_raw"));
}

}  // namespace
}  // namespace lapis::recorder
