#include "simulator/core/loaders/ply.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "simulator/core/assets/text_scan.hpp"

namespace lapis::simulator {
namespace {

using Bytes = std::span<const std::uint8_t>;

enum class Format { kAscii, kLittleEndian, kBigEndian };
enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t size_of(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8: return 1;
    case Type::kInt16:
    case Type::kUint16: return 2;
    case Type::kFloat64: return 8;
    default: return 4;
  }
}

std::optional<Type> parse_type(std::string_view name) {
  if (name == "char" || name == "int8") return Type::kInt8;
  if (name == "uchar" || name == "uint8") return Type::kUint8;
  if (name == "short" || name == "int16") return Type::kInt16;
  if (name == "ushort" || name == "uint16") return Type::kUint16;
  if (name == "int" || name == "int32") return Type::kInt32;
  if (name == "uint" || name == "uint32") return Type::kUint32;
  if (name == "float" || name == "float32") return Type::kFloat32;
  if (name == "double" || name == "float64") return Type::kFloat64;
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type = Type::kFloat32;       ///< of the value, or of the items of a list
  std::optional<Type> length_type;  ///< of the length of a list; nothing: no list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  std::optional<std::size_t> find(std::string_view property) const {
    const auto it =
        std::find_if(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property; });
    if (it == properties.end()) return std::nullopt;
    return static_cast<std::size_t>(it - properties.begin());
  }
};

struct Header {
  Format format = Format::kAscii;
  std::vector<Element> elements;
};

// One vertex or face: the numbers, with 0 in place of lists, and the items of the list of vertex indices.
struct Row {
  std::vector<double> values;
  std::vector<double> indices;
};

class PlyReader {
 public:
  PlyReader(Bytes bytes, const std::string& file, const std::vector<std::string>& face_labels)
      : bytes_(bytes), file_(file), face_labels_(face_labels) {}

  PlyMesh read();

 private:
  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(file_ + ": " + what); }
  std::string_view take_header_line();
  void read_header();
  void read_header_line(std::string_view line);
  void read_format(std::string_view line);
  void read_element_line(std::string_view line);
  void read_property_line(std::string_view line);

  void read_rows(const Element& element, std::optional<std::size_t> index_list,
                 const std::function<void(const Row&)>& use);
  void check_size(const Element& element) const;
  void read_list(const Property& property, std::vector<double>* items);
  double read_value(Type type);
  double read_word();
  template <class Number>
  double read_binary();
  std::size_t remaining() const { return bytes_.size() - at_; }

  std::optional<std::size_t> find_number(const Element& element, std::string_view property) const;
  std::array<std::size_t, 3> require_position(const Element& element) const;
  std::optional<std::array<std::size_t, 3>> find_color(const Element& element) const;
  void read_vertices(const Element& element);
  void read_faces(const Element& element);
  std::vector<std::size_t> require_labels(const Element& element) const;
  std::uint32_t to_index(double value) const;
  std::int64_t to_label(double value) const;

  Bytes bytes_;
  const std::string& file_;
  const std::vector<std::string>& face_labels_;
  std::size_t at_ = 0;
  Header header_;
  PlyMesh mesh_;
  std::size_t face_ = 0;
};

PlyMesh PlyReader::read() {
  if (bytes_.empty()) fail("the file is empty (0 bytes); copy or download it again");
  read_header();
  const auto find = [this](std::string_view name) {
    return std::find_if(header_.elements.begin(), header_.elements.end(),
                        [name](const Element& e) { return e.name == name; });
  };
  const auto vertices = find("vertex"), faces = find("face");
  if (vertices == header_.elements.end() || faces == header_.elements.end() || faces < vertices) {
    fail("the header must name an element 'vertex' and after it an element 'face'; export a mesh, not points");
  }
  for (auto element = header_.elements.begin(); element <= faces; ++element) {
    check_size(*element);
    if (element == vertices) {
      read_vertices(*element);
    } else if (element == faces) {
      read_faces(*element);
    } else {
      read_rows(*element, std::nullopt, [](const Row&) {});
    }
  }
  return std::move(mesh_);
}

std::string_view PlyReader::take_header_line() {
  const std::string_view rest(reinterpret_cast<const char*>(bytes_.data()) + at_, remaining());
  const std::size_t end = rest.find('\n');
  if (end == std::string_view::npos) fail("the header has no end; copy or download the file again");
  at_ += end + 1;
  return trimmed(rest.substr(0, end));
}

void PlyReader::read_header() {
  constexpr std::string_view kMagic = "ply";
  const bool is_ply = bytes_.size() > kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes_.begin());
  if (!is_ply || take_header_line() != kMagic) fail("is no PLY file (its first line is not 'ply')");
  for (auto line = take_header_line(); line != "end_header"; line = take_header_line()) read_header_line(line);
}

void PlyReader::read_header_line(std::string_view line) {
  const std::string_view key = take_word(line);
  if (key == "format") {
    read_format(line);
  } else if (key == "element") {
    read_element_line(line);
  } else if (key == "property") {
    read_property_line(line);
  } else if (key != "comment" && key != "obj_info" && !key.empty()) {
    fail("header line '" + std::string(key.substr(0, 40)) + "' is not known; export the file again");
  }
}

void PlyReader::read_format(std::string_view line) {
  const std::string_view name = take_word(line);
  if (name == "ascii") {
    header_.format = Format::kAscii;
  } else if (name == "binary_little_endian") {
    header_.format = Format::kLittleEndian;
  } else if (name == "binary_big_endian") {
    header_.format = Format::kBigEndian;
  } else {
    fail("format '" + std::string(name.substr(0, 40)) + "' is not known; export the file again");
  }
}

void PlyReader::read_element_line(std::string_view line) {
  const std::string_view name = take_word(line);
  const auto count = to_number<std::size_t>(take_word(line));
  if (name.empty() || !count) fail("an element needs a name and a count; export the file again");
  header_.elements.push_back({std::string(name), *count, {}});
}

void PlyReader::read_property_line(std::string_view line) {
  if (header_.elements.empty()) fail("a property comes before any element; export the file again");
  Property property;
  std::string_view word = take_word(line);
  if (word == "list") {
    property.length_type = parse_type(take_word(line));
    if (!property.length_type) fail("the length of a list has no known type; export the file again");
    word = take_word(line);
  }
  const auto type = parse_type(word);
  property.name = take_word(line);
  if (!type || property.name.empty()) fail("a property needs a known type and a name; export the file again");
  property.type = *type;
  header_.elements.back().properties.push_back(std::move(property));
}

// Refuses a file that is shorter than its rows can be: a list has at least its length, and a number in a text has at
// least one digit and a blank.
void PlyReader::check_size(const Element& element) const {
  std::size_t row_size = 0;
  for (const auto& property : element.properties)
    row_size += header_.format == Format::kAscii ? 2 : size_of(property.length_type.value_or(property.type));
  const std::size_t available = remaining() + (header_.format == Format::kAscii ? 1 : 0);
  if (row_size > 0 && element.count > available / row_size) {
    fail("the header promises " + std::to_string(element.count) + " of '" + element.name +
         "', the file is too short for them; copy or download it again");
  }
}

void PlyReader::read_rows(const Element& element, std::optional<std::size_t> index_list,
                          const std::function<void(const Row&)>& use) {
  if (element.properties.empty()) return;
  Row row;
  row.values.resize(element.properties.size());
  for (std::size_t i = 0; i < element.count; ++i) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.length_type) {
        read_list(property, index_list == k ? &row.indices : nullptr);
      } else {
        row.values[k] = read_value(property.type);
      }
    }
    use(row);
  }
}

void PlyReader::read_list(const Property& property, std::vector<double>* items) {
  const double length = read_value(*property.length_type);
  if (!(length >= 0 && length <= static_cast<double>(remaining()))) {
    fail("a list is longer than the file; copy or download it again");
  }
  if (items) items->clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(length); ++i) {
    const double value = read_value(property.type);
    if (items) items->push_back(value);
  }
}

double PlyReader::read_value(Type type) {
  if (header_.format == Format::kAscii) return read_word();
  switch (type) {
    case Type::kInt8: return read_binary<std::int8_t>();
    case Type::kUint8: return read_binary<std::uint8_t>();
    case Type::kInt16: return read_binary<std::int16_t>();
    case Type::kUint16: return read_binary<std::uint16_t>();
    case Type::kInt32: return read_binary<std::int32_t>();
    case Type::kUint32: return read_binary<std::uint32_t>();
    case Type::kFloat32: return read_binary<float>();
    case Type::kFloat64: return read_binary<double>();
  }
  return 0;
}

double PlyReader::read_word() {
  std::string_view rest(reinterpret_cast<const char*>(bytes_.data()) + at_, remaining());
  const std::string_view word = take_word(rest);
  at_ = bytes_.size() - rest.size();
  if (word.empty()) fail("the file ends too early; copy or download it again");
  const auto value = to_number<double>(word);
  if (!value) fail("'" + std::string(word.substr(0, 40)) + "' is no number; export the file again");
  return *value;
}

template <class Number>
double PlyReader::read_binary() {
  static_assert(std::endian::native == std::endian::little);
  if (remaining() < sizeof(Number)) fail("the file ends too early; copy or download it again");
  std::array<std::uint8_t, sizeof(Number)> raw;
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), raw.size(), raw.begin());
  at_ += raw.size();
  if (header_.format == Format::kBigEndian) std::reverse(raw.begin(), raw.end());
  Number value;
  std::memcpy(&value, raw.data(), raw.size());
  return static_cast<double>(value);
}

std::optional<std::size_t> PlyReader::find_number(const Element& element, std::string_view property) const {
  const auto found = element.find(property);
  if (found && element.properties[*found].length_type) {
    fail("property '" + std::string(property) + "' must be a number, not a list; export the file again");
  }
  return found;
}

std::array<std::size_t, 3> PlyReader::require_position(const Element& element) const {
  const auto x = find_number(element, "x"), y = find_number(element, "y"), z = find_number(element, "z");
  if (!x || !y || !z) fail("the vertices need the properties x, y and z; export the file again");
  return {*x, *y, *z};
}

std::optional<std::array<std::size_t, 3>> PlyReader::find_color(const Element& element) const {
  std::array<std::size_t, 3> channels{};
  const std::array<std::string_view, 3> names{"red", "green", "blue"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = find_number(element, names[i]);
    if (!found || element.properties[*found].type != Type::kUint8) return std::nullopt;
    channels[i] = *found;
  }
  return channels;
}

geometry::Rgb8 color_of(const Row& row, const std::array<std::size_t, 3>& channels) {
  const auto byte = [&](std::size_t i) {  // a uchar in an ascii file may have any value
    const double value = row.values[channels[i]];
    return value >= 0 && value <= 255 ? static_cast<std::uint8_t>(value) : std::uint8_t{0};
  };
  return {byte(0), byte(1), byte(2)};
}

void PlyReader::read_vertices(const Element& element) {
  const auto [x, y, z] = require_position(element);
  const auto color = find_color(element);
  mesh_.positions.reserve(element.count);
  if (color) mesh_.vertex_colors.reserve(element.count);
  read_rows(element, std::nullopt, [&, x = x, y = y, z = z](const Row& row) {
    mesh_.positions.emplace_back(static_cast<float>(row.values[x]), static_cast<float>(row.values[y]),
                                 static_cast<float>(row.values[z]));
    if (color) mesh_.vertex_colors.push_back(color_of(row, *color));
  });
}

std::vector<std::size_t> PlyReader::require_labels(const Element& element) const {
  std::vector<std::size_t> columns;
  for (const auto& label : face_labels_) {
    const auto found = find_number(element, label);
    if (!found) fail("the faces need the property '" + label + "'; it says which thing a face belongs to");
    columns.push_back(*found);
  }
  return columns;
}

void PlyReader::read_faces(const Element& element) {
  auto list = element.find("vertex_indices");
  if (!list) list = element.find("vertex_index");
  if (!list || !element.properties[*list].length_type) {
    fail("the faces need the list property 'vertex_indices'; export the file again");
  }
  const std::vector<std::size_t> labels = require_labels(element);
  const auto color = find_color(element);
  mesh_.triangles.reserve(element.count);
  mesh_.face_labels.resize(labels.size());
  read_rows(element, list, [&](const Row& row) {
    for (std::size_t i = 2; i < row.indices.size(); ++i) {
      mesh_.triangles.push_back({to_index(row.indices[0]), to_index(row.indices[i - 1]), to_index(row.indices[i])});
      for (std::size_t k = 0; k < labels.size(); ++k) mesh_.face_labels[k].push_back(to_label(row.values[labels[k]]));
      if (color) mesh_.face_colors.push_back(color_of(row, *color));
    }
    ++face_;
  });
}

std::uint32_t PlyReader::to_index(double value) const {
  if (!(value >= 0 && value < static_cast<double>(mesh_.positions.size()))) {
    fail("face " + std::to_string(face_) + " names a vertex that is not there; there are " +
         std::to_string(mesh_.positions.size()) + "; export the file again");
  }
  return static_cast<std::uint32_t>(value);
}

std::int64_t PlyReader::to_label(double value) const {
  constexpr double kLargest = std::numeric_limits<std::uint32_t>::max();
  if (!(value >= -kLargest && value <= kLargest)) {
    fail("face " + std::to_string(face_) + " has a label that is no number of 32 bits; export the file again");
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace

PlyMesh read_ply(std::span<const std::uint8_t> bytes, const std::string& file,
                 const std::vector<std::string>& face_labels) {
  return PlyReader(bytes, file, face_labels).read();
}

}  // namespace lapis::simulator
