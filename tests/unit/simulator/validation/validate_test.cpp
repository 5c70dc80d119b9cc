#include "simulator/core/validation/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scenes.hpp"

namespace lapis::simulator {
namespace {

ValidationConfig small_config() {
  ValidationConfig config;
  config.features.camera = {320, 180, 160.0, 160.0, 159.5, 89.5};
  config.features.mount.height_m = 1.0;
  config.features.max_views = 40;
  return config;
}

std::vector<Check> run(const World& world) {
  return validate(world, small_config(), [](const std::string&) {});
}

std::vector<FeatureView> views_with(std::size_t poor, std::size_t all) {
  std::vector<FeatureView> views(all, {{1, 1}, 0.0, 900});
  for (std::size_t i = 0; i < poor; ++i) views[i * (all / (poor + 1))].features = 99;
  return views;
}

double mean_features(const std::vector<FeatureView>& views) {
  double sum = 0.0;
  for (const auto& view : views) sum += view.features;
  return sum / static_cast<double>(views.size());
}

TEST(Validate, AGoodSceneHasNoFailuresAndTheSameTableTwice) {
  const World world(test::build(test::good_spec()), {});
  auto first = run(world), second = run(world);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(test::text_of(first[i]), test::text_of(second[i]));
    if (first[i].name == "features") continue;  // a small picture has few, whatever it shows
    EXPECT_NE(first[i].verdict, Verdict::kFail) << test::text_of(first[i]);
  }
  EXPECT_EQ(draw_floor_plan(world, {}).pixels, draw_floor_plan(world, {}).pixels);
}

TEST(Validate, PassesUnlessACheckFails) {
  EXPECT_TRUE(passes({{"a", Verdict::kOk}, {"b", Verdict::kNote}}));
  EXPECT_FALSE(passes({{"a", Verdict::kOk}, {"b", Verdict::kFail}, {"c", Verdict::kNote}}));
}

TEST(Features, BareRoomsHaveFewerThanFurnishedOnes) {
  SceneSpec bare_spec = test::two_rooms();
  for (RoomSpec& room : bare_spec.rooms) room.floor = room.wall = room.ceiling = {"blank", {200, 200, 200}};
  const World bare(test::build(bare_spec), {}), furnished(test::build(test::good_spec()), {});
  const auto config = small_config().features;
  const auto without = measure_features(bare, config, [](const std::string&) {});
  const auto with = measure_features(furnished, config, [](const std::string&) {});
  EXPECT_LT(mean_features(without), 0.5 * mean_features(with));
}

TEST(Features, ViewsAreReachableAndAtMostAsManyAsAsked) {
  const World world(test::build(test::good_spec()), {});
  const auto views = measure_features(world, small_config().features, [](const std::string&) {});
  EXPECT_EQ(views.size(), 40U);
  const auto reachable = world.nav_map().reachable({2.0, 1.5}, 0.2);
  for (const auto& view : views) {
    const Cell c = world.nav_map().grid().cell_of(view.position);
    EXPECT_NE(reachable(c.column, c.row), 0);
  }
}

TEST(Features, ViewsAreDrawnUntilTheirShareIsBeyondDoubt) {
  EXPECT_FALSE(is_decided(0, 0));
  EXPECT_FALSE(is_decided(0, 100)) << "0.96^100 = 0.017";
  EXPECT_TRUE(is_decided(0, 300)) << "0.96^300 = 5e-6";
  EXPECT_TRUE(is_decided(100, 100));
  EXPECT_FALSE(is_decided(20, 500)) << "4 %";
  // Tails of Binomial(400, 0.04), summed with exact fractions: P(X <= 3) = 7.5e-5, P(X <= 4) = 3.3e-4,
  // P(X >= 32) = 2.0e-4, P(X >= 33) = 9.0e-5.
  EXPECT_TRUE(is_decided(3, 400));
  EXPECT_FALSE(is_decided(4, 400));
  EXPECT_FALSE(is_decided(32, 400));
  EXPECT_TRUE(is_decided(33, 400));
}

TEST(Features, MoreThanFourPercentOfPoorViewsFailExceptUnderStressOrInScenesOfOthers) {
  Scene scene;
  scene.labels = test::small_labels();
  scene.rooms = {{"den", "", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}}};
  EXPECT_EQ(check_features(scene, views_with(50, 100)).verdict, Verdict::kNote) << "no pictures";
  scene.instances = {{1, 9, "den/picture 1"}};
  EXPECT_EQ(check_features(scene, views_with(4, 100)).verdict, Verdict::kOk);
  EXPECT_EQ(check_features(scene, views_with(5, 100)).verdict, Verdict::kFail);
  EXPECT_EQ(check_features(scene, views_with(1, 200)).verdict, Verdict::kOk);
  EXPECT_EQ(check_features(scene, views_with(0, 200)).verdict, Verdict::kNote) << "nowhere to get lost";
  EXPECT_EQ(check_features(scene, {}).verdict, Verdict::kNote);
  Scene others = scene, stress = scene;
  others.rooms.clear();
  stress.is_stress = true;
  EXPECT_EQ(check_features(others, views_with(50, 100)).verdict, Verdict::kNote);
  EXPECT_EQ(check_features(stress, views_with(50, 100)).verdict, Verdict::kNote);
}

TEST(Features, PoorViewsAreListedByRoomTheWorstFirst) {
  Scene scene;
  scene.rooms = {{"den", "", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}}, {"attic", "", {{3, 0}, {5, 0}, {5, 2}, {3, 2}}}};
  auto views = views_with(0, 50);
  views[10] = {{4.0, 1.0}, 0.0, 0};
  views[20] = {{0.5, 1.5}, 1.5707963, 42};
  views[30] = {{1.5, 0.25}, 0.0, 3};
  EXPECT_THAT(check_features(scene, views).details,
              ::testing::ElementsAre("den: 2 of 49 views; (1.50, 0.25) at 0 deg: 3, (0.50, 1.50) at 90 deg: 42",
                                     "attic: 1 of 1 views; (4.00, 1.00) at 0 deg: 0"));
}

}  // namespace
}  // namespace lapis::simulator
