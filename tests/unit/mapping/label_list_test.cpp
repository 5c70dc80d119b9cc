#include "common/mapping/model/label_list.hpp"

#include <set>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

namespace lapis::mapping {
namespace {

TEST(LabelList, IsSortedByIdAndNamesWhatItLacks) {
  const auto list = LabelList::from_names({{4, "door"}, {1, "wall"}});
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list.labels()[0].id, 1);
  EXPECT_EQ(list.name(1), "wall");
  EXPECT_EQ(list.name(4), "door");
  EXPECT_EQ(list.name(0), "unlabelled");
  EXPECT_EQ(list.name(9), "class 9");
  EXPECT_EQ(list.max_id(), 4);
  EXPECT_EQ(list.largest_accepted_id(), 4);
  EXPECT_EQ(LabelList().largest_accepted_id(), 65535);
  EXPECT_TRUE(list.contains(4));
  EXPECT_FALSE(list.contains(2));
  EXPECT_EQ(list.id_of("door"), 4);
  EXPECT_EQ(list.id_of("window"), std::nullopt);
}

TEST(LabelList, RefusesZeroAndRepeatedIds) {
  EXPECT_THROW(LabelList::from_names({{0, "void"}}), std::runtime_error);
  EXPECT_THROW(LabelList::from_names({{2, "a"}, {2, "b"}}), std::runtime_error);
}

TEST(LabelList, UnionHasTheClassesOfBothAndOneNameForEach) {
  const LabelList a = LabelList::from_names({{1, "wall"}, {4, "door"}}),
                  b = LabelList::from_names({{4, "door"}, {2, "floor"}});
  EXPECT_EQ(LabelList::united(a, b), LabelList::from_names({{1, "wall"}, {2, "floor"}, {4, "door"}}));
  EXPECT_EQ(LabelList::united(a, {}), a);
  EXPECT_THROW(LabelList::united(a, LabelList::from_names({{1, "floor"}})), std::runtime_error);
}

TEST(DefaultColor, IsDistinctForUsualLists) {
  std::set<std::tuple<int, int, int>> colors;
  for (std::uint16_t id = 0; id <= 255; ++id) {
    const geometry::Rgb8 c = default_color(id);
    colors.emplace(c.r, c.g, c.b);
  }
  EXPECT_EQ(colors.size(), 256u);
}

}  // namespace
}  // namespace lapis::mapping
