#include "sensor_replay/core/tum_lists.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

#include "sensor_replay/core/text_table.hpp"
#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

using test::error_of;
using test::write_text;
using testing::HasSubstr;

TEST(ParseStamp, KeepsEveryDigit) {
  EXPECT_EQ(parse_stamp("1305031102.175304")->nanoseconds, 1305031102175304000);
  EXPECT_EQ(parse_stamp("0.033333")->nanoseconds, 33333000);
  EXPECT_EQ(parse_stamp("7")->nanoseconds, 7000000000);
  EXPECT_EQ(parse_stamp("1.1234567899")->nanoseconds, 1123456789);
  EXPECT_EQ(parse_stamp("-0.5")->nanoseconds, -500000000);
}

TEST(ParseStamp, RefusesEverythingElse) {
  for (const char* text : {"", "-", ".", "1.", ".5", "1e9", "1.2.3", "abc", "1.5s", "--1", "+1", "nan", " 1",
                           "99999999999", "9223372036854775808"}) {
    EXPECT_FALSE(parse_stamp(text)) << text;
  }
}

TEST(ParseNumber, RefusesEverythingButFiniteNumbers) {
  EXPECT_EQ(parse_number("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_number("+2"), 2.0);
  for (const char* text : {"", "+", "nan", "inf", "-inf", "1e999", "1,5", "0x10", "12 ", "a"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

class ListFile : public testing::Test {
 protected:
  std::string images_error(const std::string& text) {
    write_text(file_, text);
    return error_of([&] { read_image_list(file_); });
  }
  std::string associations_error(const std::string& text) {
    write_text(file_, text);
    return error_of([&] { read_associations(file_); });
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "list.txt";
};

TEST_F(ListFile, SkipsCommentsAndBlankLinesAndTakesWindowsLineEnds) {
  write_text(file_, "# comment\r\n\r\n  0.5 \t rgb/a.png \r\n1.5 rgb/b.png");
  const auto images = read_image_list(file_);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].file, "rgb/a.png");
  EXPECT_EQ(images[1].stamp, time::Time::from_seconds(1.5));
}

TEST_F(ListFile, ErrorsNameFileAndLine) {
  const std::string where = file_.string() + ":";
  EXPECT_THAT(images_error("0.1 a\n0.3 b\n0.2 c\n"), testing::StartsWith(where + "3: time stamps are not sorted"));
  EXPECT_THAT(images_error("# x\n0.1 a\n0.1 b\n"),
              testing::StartsWith(where + "3: time stamp 0.100000000 occurs twice"));
  EXPECT_THAT(images_error("0.1\n"), testing::StartsWith(where + "1: 1 fields instead of 2"));
  EXPECT_THAT(images_error("0.1 a b\n"), testing::StartsWith(where + "1: 3 fields instead of 2"));
  EXPECT_THAT(images_error("soon a\n"), testing::StartsWith(where + "1: \"soon\" is not a time stamp"));
  EXPECT_THAT(error_of([&] { read_image_list(folder_.path() / "none.txt"); }), HasSubstr("none.txt: cannot be read"));
  EXPECT_THAT(error_of([&] { read_image_list(folder_.path()); }), HasSubstr("cannot be read"));
}

TEST_F(ListFile, AssociationErrorsNameFileAndLine) {
  const std::string where = file_.string() + ":";
  EXPECT_THAT(associations_error("0.1 a 0.1\n"), testing::StartsWith(where + "1: 3 fields instead of 4"));
  EXPECT_THAT(associations_error("0.2 a 0.2 d\n0.1 b 0.1 e\n"), testing::StartsWith(where + "2: time stamps are not"));
  EXPECT_THAT(associations_error("0.2 a 0.2 d\n0.2 b 0.3 e\n"), HasSubstr(":2: time stamp 0.200000000 occurs twice"));
  EXPECT_THAT(associations_error("0.1 a 0.1 d\n0.2 b 0.1 d\n"), HasSubstr(":2: d belongs to two colour images"));
  EXPECT_THAT(associations_error("0.1 a x d\n"), HasSubstr(":1: \"x\" is not a time stamp"));
}

// The definition itself: take the closest unused pair of all, again and again.
std::vector<Association> associate_by_definition(const std::vector<time::Time>& a, const std::vector<time::Time>& b,
                                                 time::Duration limit) {
  std::vector<Association> pairs;
  std::set<std::size_t> used_a;
  std::set<std::size_t> used_b;
  while (true) {
    std::optional<Association> best;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        if (used_a.contains(i) || used_b.contains(j) || time::abs(a[i] - b[j]) > limit) continue;
        if (!best || time::abs(a[i] - b[j]) < time::abs(a[best->first] - b[best->second])) best = Association{i, j};
      }
    }
    if (!best) break;
    used_a.insert(best->first);
    used_b.insert(best->second);
    pairs.push_back(*best);
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  return pairs;
}

TEST(Associate, IsOneToOneWithinTheLimitAndFollowsTheDefinition) {
  std::mt19937 engine(7);
  std::uniform_int_distribution<std::int64_t> gap(1, 60'000'000);
  std::uniform_int_distribution<int> count(0, 30);
  const time::Duration limit = time::Duration::from_seconds(0.02);
  for (int round = 0; round < 200; ++round) {
    std::vector<time::Time> lists[2];
    for (auto& list : lists) {
      time::Time t;
      for (int i = count(engine); i > 0; --i) list.push_back(t = t + time::Duration{gap(engine)});
    }
    const auto pairs = associate(lists[0], lists[1], limit);
    const auto expected = associate_by_definition(lists[0], lists[1], limit);
    ASSERT_EQ(pairs.size(), expected.size()) << "round " << round;
    std::set<std::size_t> first;
    std::set<std::size_t> second;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      EXPECT_EQ(pairs[k].first, expected[k].first);
      EXPECT_EQ(pairs[k].second, expected[k].second);
      EXPECT_TRUE(first.insert(pairs[k].first).second);
      EXPECT_TRUE(second.insert(pairs[k].second).second);
      EXPECT_LE(time::abs(lists[0][pairs[k].first] - lists[1][pairs[k].second]), limit);
    }
  }
}

TEST(Associate, TheLimitItselfCounts) {
  const std::vector<time::Time> a{time::Time{0}};
  const time::Duration limit{20};
  EXPECT_EQ(associate(a, {time::Time{20}}, limit).size(), 1u);
  EXPECT_EQ(associate(a, {time::Time{21}}, limit).size(), 0u);
}

TEST(PairByStamp, KeepsColourImagesWithoutDepth) {
  const std::vector<ListedImage> color{{time::Time{0}, "c0"}, {time::Time{100}, "c1"}, {time::Time{200}, "c2"}};
  const std::vector<ListedImage> depth{{time::Time{3}, "d0"}, {time::Time{195}, "d1"}};
  const auto frames = pair_by_stamp(color, depth, time::Duration{20});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].depth->file, "d0");
  EXPECT_FALSE(frames[1].depth);
  EXPECT_EQ(frames[2].depth->file, "d1");
}

}  // namespace
}  // namespace lapis::sensor_replay
