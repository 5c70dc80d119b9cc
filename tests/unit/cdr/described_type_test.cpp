#include "common/cdr/described_type.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "common/cdr/decode.hpp"
#include "common/cdr/encode.hpp"
#include "idl/type_table.hpp"

namespace lapis::cdr {
namespace {

Value description_of(const idl::TypeEntry& type) {
  Value fields = Value::array();
  for (const idl::FieldEntry& field : type.fields) {
    fields.push_back({{"name", std::string(field.name)},
                      {"type",
                       {{"type_id", field.type_id},
                        {"capacity", field.capacity},
                        {"string_capacity", field.string_capacity},
                        {"nested_type_name", std::string(field.nested_type)}}}});
  }
  return {{"type_name", std::string(type.ros_name)}, {"fields", fields}};
}

void expect_equal(const Layout& layout, std::size_t index, const Layout& other, std::size_t other_index) {
  const auto &fields = layout.structures[index].fields, &others = other.structures[other_index].fields;
  ASSERT_EQ(fields.size(), others.size()) << layout.structures[index].name;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    EXPECT_EQ(fields[i].name, others[i].name);
    EXPECT_EQ(fields[i].kind, others[i].kind) << fields[i].name;
    EXPECT_EQ(fields[i].container, others[i].container) << fields[i].name;
    EXPECT_EQ(fields[i].capacity, others[i].capacity) << fields[i].name;
    EXPECT_EQ(fields[i].string_bound, others[i].string_bound) << fields[i].name;
    if (fields[i].kind == Kind::kStructure) expect_equal(layout, fields[i].structure, other, others[i].structure);
  }
}

TEST(DescribedType, IsThatOfTheDeclaration) {
  Value all = Value::array();
  for (const idl::TypeEntry& entry : idl::type_table()) all.push_back(description_of(entry));
  for (const idl::TypeEntry& entry : idl::type_table()) {
    const Layout layout =
        layout_of_description({{"type_description", description_of(entry)}, {"referenced_type_descriptions", all}});
    expect_equal(layout, 0, parse_ros2msg(entry.ros_name, entry.ros2msg_text), 0);
  }
}

Value with_field(int type_id, const std::string& nested) {
  const Value type{{"type_id", type_id}, {"capacity", 0}, {"string_capacity", 0}, {"nested_type_name", nested}};
  const Value fields = Value::array({{{"name", "a"}, {"type", type}}});
  return {{"type_description", {{"type_name", "a_msgs/msg/A"}, {"fields", fields}}},
          {"referenced_type_descriptions", Value::array()}};
}

TEST(DescribedType, ThatCannotBeReadIsRefused) {
  EXPECT_NO_THROW(layout_of_description(with_field(6, "")));
  EXPECT_EQ(layout_of_description(with_field(13, "")).structures[0].fields[0].kind, Kind::kUint8) << "char";
  for (const int type_id : {0, 12, 14, 18, 18 + 48, 18 + 144}) {
    EXPECT_THROW(layout_of_description(with_field(type_id, "")), std::runtime_error) << type_id;
  }
  EXPECT_THROW(layout_of_description(with_field(1, "b_msgs/msg/B")), std::runtime_error);
  EXPECT_THROW(layout_of_description(with_field(1, "a_msgs/msg/A")), std::runtime_error) << "contains itself";
}

}  // namespace
}  // namespace lapis::cdr
