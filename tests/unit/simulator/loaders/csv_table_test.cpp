#include "simulator/core/loaders/csv_table.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CsvTable, FieldsInQuotesMayHoldSeparatorsAndQuotes) {
  EXPECT_THAT(split_fields("1,\"a, \"\"b\"\"\",,x\r\n", ','), ElementsAre("1", "a, \"b\"", "", "x"));
  EXPECT_THAT(split_fields("", ','), ElementsAre(""));
  EXPECT_THAT(split_fields("a,", ','), ElementsAre("a", ""));
}

TEST(CsvTable, QuotesThatDoNotEncloseAFieldArePartOfIt) {
  EXPECT_THAT(split_fields("\"open,2", ','), ElementsAre("\"open", "2"));
  EXPECT_THAT(split_fields("\"22\" screen\tx", '\t'), ElementsAre("\"22\" screen", "x"));
}

TEST(CsvTable, FindsFieldsByColumn) {
  const CsvTable table("id,name\n\n4,door\n", ',', "f.csv");
  ASSERT_EQ(table.rows().size(), 1U);
  EXPECT_EQ(table.at(table.rows()[0], "name"), "door");
  EXPECT_EQ(table.index_at(table.rows()[0], "id", 10), 4U);
  EXPECT_FLOAT_EQ(table.float_at(table.rows()[0], "id"), 4.0F);
}

TEST(CsvTable, ErrorsNameFileLineAndColumn) {
  const CsvTable table("id,name,size\n\n-1,door,nan\n70000\n", ',', "f.csv");
  const auto& first = table.rows()[0];
  EXPECT_THAT(test::error_of([&] { table.index_at(first, "id", 10); }), HasSubstr("f.csv: line 3: id"));
  EXPECT_THAT(test::error_of([&] { table.float_at(first, "size"); }), HasSubstr("f.csv: line 3: size"));
  EXPECT_THAT(test::error_of([&] { table.at(first, "color"); }), HasSubstr("no column 'color'"));
  EXPECT_THAT(test::error_of([&] { table.index_at(table.rows()[1], "id", 65535); }), HasSubstr("up to 65535"));
  EXPECT_THAT(test::error_of([&] { table.at(table.rows()[1], "name"); }), HasSubstr("f.csv: line 4: the field 'name'"));
}

}  // namespace
}  // namespace lapis::simulator
