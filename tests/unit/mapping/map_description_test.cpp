#include "common/mapping/file/map_description.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace lapis::mapping {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string problem_of(const MapDescription& description) {
  try {
    validate(description);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MapDescriptionTest, DefaultsAreValid) { EXPECT_EQ(problem_of({}), ""); }

TEST(MapDescriptionTest, EveryValueThatCannotBeIsNamed) {
  struct Case {
    std::function<void(MapDescription&)> spoil;
    const char* named;
  };
  const std::vector<Case> cases{
      {[](auto& d) { d.resolution_m = kNaN; }, "resolution_m"},
      {[](auto& d) { d.resolution_m = 0.6; }, "resolution_m"},
      {[](auto& d) { d.frames.stride = 0; }, "stride"},
      {[](auto& d) { d.frames.integration.max_range_m = kNaN; }, "max_range_m"},
      {[](auto& d) { d.frames.integration.min_height_m = -kInfinity; }, "min_height_m"},
      {[](auto& d) { d.frames.integration.kernel_length_voxels = 1.0; }, "kernel_length_voxels"},
      {[](auto& d) {
         d.resolution_m = 0.02;
         d.frames.integration.max_range_m = 11.0;
       },
       "500 voxels"},
      {[](auto& d) { d.sensor_model.prior_occupied = 1.0; }, "prior_occupied"},
      {[](auto& d) { d.sensor_model.hit_gain = kNaN; }, "hit_gain"},
      {[](auto& d) { d.sensor_model.share_limit = kInfinity; }, "limits"},
      {[](auto& d) { d.sensor_model.fusion = "sum"; }, "fusion"},
      {[](auto& d) { d.sensor_model.class_count = 0; }, "class_count"},
      {[](auto& d) {
         d.labels = LabelList::from_names({{1, "wall"}, {7, "chair"}});
       },
       "class_count"},
  };
  for (const Case& c : cases) {
    MapDescription description;
    c.spoil(description);
    EXPECT_THAT(problem_of(description), HasSubstr(c.named));
  }
}

TEST(MapDescriptionTest, ClassesAreThoseOfTheLabels) {
  MapDescription description;
  description.labels = LabelList::from_names({{1, "wall"}, {7, "chair"}});
  description.sensor_model = with_classes(description.sensor_model, description.labels);
  EXPECT_EQ(description.sensor_model.class_count, 7);
  EXPECT_EQ(problem_of(description), "");
  EXPECT_EQ(with_classes(description.sensor_model, {}).class_count, 7) << "without a list the number stays";
}

TEST(MapDescriptionTest, TheFirstDifferenceIsNamedWithBothValues) {
  const MapDescription a;
  MapDescription b = a;
  EXPECT_EQ(difference(a, b), "");
  b.epoch = 5;
  b.labels = LabelList::from_names({{1, "wall"}, {7, "chair"}});
  b.sensor_model = with_classes(b.sensor_model, b.labels);
  EXPECT_EQ(difference(a, b), "") << "what changes while a mapper runs";
  b.sensor_model.prior_occupied = 0.1;
  EXPECT_EQ(difference(a, b), "prior_occupied 0.2 and 0.1");
  b.frames.stride = 4;
  EXPECT_EQ(difference(a, b), "frame.stride 2 and 4");
  EXPECT_EQ(difference(a.frames, b.frames), "frame.stride 2 and 4");
  b.resolution_m = 0.1;
  EXPECT_EQ(difference(a, b), "resolution_m 0.25 and 0.1");
}

TEST(MapDescriptionTest, AReferenceHasNoKernel) {
  FrameSettings frames;
  frames.integration.kernel_length_voxels = 2.0;
  EXPECT_EQ(of_reference(frames), FrameSettings{});
  EXPECT_EQ(difference(frames, FrameSettings{}), "");
}

}  // namespace
}  // namespace lapis::mapping
