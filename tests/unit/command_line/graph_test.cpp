#include "command_line/core/graph.hpp"

#include <gtest/gtest.h>

namespace lapis::command_line {
namespace {

TEST(Graph, HasTopicsWithTheirWritersReadersAndTypes) {
  const auto topics = topics_of({{.is_writer = false, .topic = "/b", .type = "y"},
                                 {.is_writer = true, .topic = "/b", .type = "x", .node = "/one"},
                                 {.is_writer = true, .topic = "/a", .type = "x"},
                                 {.is_writer = true, .topic = "/b", .type = "x", .node = "/two"}});
  ASSERT_EQ(topics.size(), 2U);
  EXPECT_EQ(topics[0].name, "/a");
  EXPECT_EQ(topics[1].types, (std::vector<std::string>{"x", "y"}));
  ASSERT_EQ(topics[1].writers.size(), 2U);
  EXPECT_EQ(topics[1].writers[1].node, "/two");
  EXPECT_EQ(topics[1].readers.size(), 1U);
}

TEST(Graph, NamesWhatThereIsInstead) {
  EXPECT_EQ(not_among("topic", "/x", {"/a", "/b"}), "no topic /x; there are /a, /b");
  EXPECT_EQ(not_among("service", "/x", {}), "no service /x; there is none at all (lapis doctor says more)");
}

TEST(Graph, KnowsTheTypeOfAServiceByItsRequest) {
  EXPECT_EQ((SeenService{"/pause", "std_srvs/srv/Trigger_Request", ""}.type()), "std_srvs/srv/Trigger");
}

}  // namespace
}  // namespace lapis::command_line
