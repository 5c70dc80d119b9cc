#include "simulator/core/assets/java_properties.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

std::map<std::string, std::string> parsed(std::string_view text) { return parse_java_properties(test::to_bytes(text)); }

// The examples in the documentation of java.util.Properties.load.
TEST(JavaProperties, ReadsTheExamplesOfItsDocumentation) {
  for (const auto* line : {"Truth = Beauty", " Truth:Beauty", "Truth                    :Beauty"})
    EXPECT_THAT(parsed(line), ElementsAre(Pair("Truth", "Beauty"))) << line;
  EXPECT_THAT(parsed("fruits                           apple, banana, pear, \\\n"
                     "                                 cantaloupe, watermelon, \\\r\n"
                     "                                 kiwi, mango\n"),
              ElementsAre(Pair("fruits", "apple, banana, pear, cantaloupe, watermelon, kiwi, mango")));
  EXPECT_THAT(parsed("cheeses"), ElementsAre(Pair("cheeses", "")));
}

TEST(JavaProperties, SkipsCommentsAndEmptyLines) {
  EXPECT_THAT(parsed("# a=1\n  ! b=2\n\n \t\n"), IsEmpty());
  EXPECT_THAT(parsed("# a comment is never continued \\\nid#1=x"), ElementsAre(Pair("id#1", "x")));
}

TEST(JavaProperties, EscapesAndLatin1BecomeUtf8) {
  EXPECT_THAT(parsed("k=\xE9t\xE9"), ElementsAre(Pair("k", "été")));
  EXPECT_THAT(parsed("k=\\u00e9 \\u20AC \\ud83d\\uDE00"), ElementsAre(Pair("k", "é € 😀")));
  EXPECT_THAT(parsed("a\\=b\\ c=x\\ty\\\\"), ElementsAre(Pair("a=b c", "x\ty\\")));
  EXPECT_THAT(parsed("k=\\q"), ElementsAre(Pair("k", "q")));
}

TEST(JavaProperties, BrokenEscapesBecomeReplacementCharacters) {
  EXPECT_THAT(parsed("k=\\u12"), ElementsAre(Pair("k", "\uFFFD12")));
  EXPECT_THAT(parsed("k=\\ud83dx"), ElementsAre(Pair("k", "\uFFFDx")));
  EXPECT_THAT(parsed("k=\\udE00"), ElementsAre(Pair("k", "\uFFFD")));
  EXPECT_THAT(parsed("k=x\\"), ElementsAre(Pair("k", "x")));
}

TEST(JavaProperties, TheLastValueCounts) { EXPECT_THAT(parsed("k=1\nk=2\rk=3"), ElementsAre(Pair("k", "3"))); }

}  // namespace
}  // namespace lapis::simulator
