#include "sensor_replay/core/class_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::error_of;
using test::write_text;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(ClassList, SortsByIdAndLeavesOutUnlabelled) {
  const test::TemporaryFolder folder;
  write_text(folder.path() / "classes.csv", "class_id,class,instances\n7,picture frame,3\n0,void,1\n2,floor,1\n");
  EXPECT_THAT(read_class_list(folder.path() / "classes.csv"),
              ElementsAre(ClassName{2, "floor"}, ClassName{7, "picture frame"}));
}

TEST(ClassList, ErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "classes.csv";
  const auto error = [&](const std::string& text) {
    write_text(file, text);
    return error_of([&] { read_class_list(file); });
  };
  EXPECT_THAT(error(""), HasSubstr("classes.csv: must begin with the header"));
  EXPECT_THAT(error("1,wall\n"), HasSubstr("must begin with the header"));
  EXPECT_THAT(error("class_id,class\n1,wall\n1,floor\n"), HasSubstr("classes.csv:3: class_id 1 occurs twice"));
  EXPECT_THAT(error("class_id,class\n1,\n"), HasSubstr("classes.csv:2: the class has no name"));
  EXPECT_THAT(error("class_id,class\n1\n"), HasSubstr("classes.csv:2: the class has no name"));
  for (const char* id : {"x", "-1", "1.5", "65536", ""}) {
    EXPECT_THAT(error("class_id,class\n" + std::string(id) + ",wall\n"), HasSubstr("classes.csv:2: class_id must be"));
  }
  EXPECT_THAT(error_of([&] { read_class_list(folder.path() / "none.csv"); }), HasSubstr("none.csv: cannot be read"));
}

}  // namespace
}  // namespace lapis::sensor_replay
