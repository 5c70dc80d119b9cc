#include "common/mapping/label_list.hpp"

#include <set>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

namespace lapis::mapping {
namespace {

TEST(LabelList, ReadsIdAndNameColumnsWhereverTheyAre) {
  std::string error;
  const auto list = LabelList::from_csv("instances,class_id,class\r\n3,4,door\r\n\r\n1,1,\"wall\"\r\n", error);
  ASSERT_TRUE(list) << error;
  ASSERT_EQ(list->size(), 2u);
  EXPECT_EQ(list->labels()[0].id, 1);
  EXPECT_EQ(list->name(1), "wall");
  EXPECT_EQ(list->name(4), "door");
  EXPECT_EQ(list->name(0), "unlabelled");
  EXPECT_EQ(list->name(9), "class 9");
  EXPECT_EQ(list->max_id(), 4);
  EXPECT_TRUE(list->contains(4));
  EXPECT_FALSE(list->contains(2));
}

TEST(LabelList, NamesTheMalformedLine) {
  const auto refused = [](const char* text, const char* part) {
    std::string error;
    EXPECT_FALSE(LabelList::from_csv(text, error)) << text;
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  refused("", "line 1");
  refused("id,name\n1,wall\n", "line 1");
  refused("class_id,class\n1,wall\nx,door\n", "line 3");
  refused("class_id,class\n1,wall\n1,door\n", "line 3");
  refused("class_id,class\n0,nothing\n", "line 2");
  refused("class_id,class\n70000,far\n", "line 2");
  refused("class_id,class\n5\n", "line 2");
}

TEST(LabelList, RefusesZeroAndRepeatedIds) {
  EXPECT_THROW(LabelList::from_names({{0, "void"}}), std::runtime_error);
  EXPECT_THROW(LabelList::from_names({{2, "a"}, {2, "b"}}), std::runtime_error);
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
