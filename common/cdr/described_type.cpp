#include "common/cdr/described_type.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace lapis::cdr {
namespace {

// type_description_interfaces/msg/FieldType: the kind, plus what says how many there are.
constexpr std::uint64_t kArrayOffset = 48, kSequenceOffset = 96, kKinds = 48;
constexpr std::array<std::pair<std::uint64_t, Kind>, 16> kDescribedKinds{{{1, Kind::kStructure},
                                                                          {2, Kind::kInt8},
                                                                          {3, Kind::kUint8},
                                                                          {4, Kind::kInt16},
                                                                          {5, Kind::kUint16},
                                                                          {6, Kind::kInt32},
                                                                          {7, Kind::kUint32},
                                                                          {8, Kind::kInt64},
                                                                          {9, Kind::kUint64},
                                                                          {10, Kind::kFloat32},
                                                                          {11, Kind::kFloat64},
                                                                          {13, Kind::kUint8},
                                                                          {15, Kind::kBool},
                                                                          {16, Kind::kByte},
                                                                          {17, Kind::kString},
                                                                          {21, Kind::kString}}};
constexpr const char* kEmptyMember = "structure_needs_at_least_one_member";

Field to_field(const Value& description, const std::vector<std::string>& names) {
  const Value& type = description.at("type");
  const auto id = type.at("type_id").get<std::uint64_t>();
  Field field{
      .name = description.at("name"), .capacity = type.at("capacity"), .string_bound = type.at("string_capacity")};
  const std::uint64_t kind = (id - 1) % kKinds + 1;
  const auto* known = std::ranges::find(kDescribedKinds, kind, [](const auto& entry) { return entry.first; });
  if (id == 0 || known == kDescribedKinds.end()) {
    throw std::runtime_error(field.name + ": type " + std::to_string(id) + " cannot be read");
  }
  field.kind = known->second;
  if (id > kSequenceOffset) {
    field.container = Container::kSequence;
  } else if (id > kArrayOffset) {
    field.container = Container::kArray;
  }
  if (field.kind != Kind::kStructure) return field;
  const auto nested = std::ranges::find(names, type.at("nested_type_name").get<std::string>());
  if (nested == names.end()) throw std::runtime_error(field.name + ": its type is not described");
  field.structure = static_cast<std::size_t>(nested - names.begin());
  return field;
}

}  // namespace

Layout layout_of_description(const Value& description) {
  std::vector<const Value*> types{&description.at("type_description")};
  for (const Value& type : description.at("referenced_type_descriptions")) types.push_back(&type);
  std::vector<std::string> names;
  for (const Value* type : types) names.push_back(type->at("type_name"));
  Layout layout;
  for (const Value* type : types) {
    Structure& structure = layout.structures.emplace_back(Structure{type->at("type_name"), {}});
    for (const Value& field : type->at("fields")) structure.fields.push_back(to_field(field, names));
    const bool is_empty = structure.fields.size() == 1 && structure.fields[0].name == kEmptyMember;
    if (is_empty) structure.fields.clear();
  }
  require_an_end(layout);
  return layout;
}

}  // namespace lapis::cdr
