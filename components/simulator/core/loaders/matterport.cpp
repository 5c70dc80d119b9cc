#include "simulator/core/loaders/matterport.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/object_ply.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"

namespace lapis::simulator {
namespace {

class HouseReader {
 public:
  HouseReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}
  House read();

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(file_ + ": line " + std::to_string(line_) + ": " + what + "; download the file again");
  }
  std::string_view skip_words(std::string_view line, int count) const;
  std::int64_t take_number(std::string_view& line) const;
  std::string take_name(std::string_view& line) const;
  void read_header(std::string_view line);
  void read_category(std::string_view line);
  void read_object(std::string_view line);
  void check_counts();

  std::string_view text_;
  const std::string& file_;
  std::size_t line_ = 0;
  House house_;
  std::int64_t promised_objects_ = 0, promised_categories_ = 0;
};

House HouseReader::read() {
  line_ = 1;
  std::string_view format = trimmed(take_line(text_));
  if (format.substr(0, 5) != "ASCII") fail("is no Matterport3D house (its first line is not 'ASCII 1.1')");
  while (!text_.empty()) {
    ++line_;
    std::string_view line = take_line(text_);
    const std::string_view key = take_word(line);
    if (key == "H") read_header(line);
    if (key == "C") read_category(line);
    if (key == "O") read_object(line);
  }
  check_counts();
  return std::move(house_);
}

std::string_view HouseReader::skip_words(std::string_view line, int count) const {
  for (int i = 0; i < count; ++i) {
    if (take_word(line).empty()) fail("the record is too short");
  }
  return line;
}

std::int64_t HouseReader::take_number(std::string_view& line) const {
  const auto number = to_number<std::int64_t>(take_word(line));
  if (!number) fail("a whole number is missing");
  return *number;
}

std::string HouseReader::take_name(std::string_view& line) const {
  std::string name(take_word(line));
  if (name.empty()) fail("a name is missing");
  std::replace(name.begin(), name.end(), '#', ' ');
  return name;
}

// H name label #images #panoramas #vertices #surfaces #segments #objects #categories ...
void HouseReader::read_header(std::string_view line) {
  line = skip_words(line, 7);
  promised_objects_ = take_number(line);
  promised_categories_ = take_number(line);
}

// C index mapping_index mapping_name mpcat40_index mpcat40_name ...
void HouseReader::read_category(std::string_view line) {
  const std::int64_t index = take_number(line);
  line = skip_words(line, 1);
  House::Category category;
  category.name = take_name(line);
  line = skip_words(line, 1);
  category.mpcat40 = take_name(line);
  if (!house_.categories.emplace(index, std::move(category)).second) fail("this category occurs twice");
}

// O index region category ...
void HouseReader::read_object(std::string_view line) {
  const std::int64_t index = take_number(line);
  line = skip_words(line, 1);
  if (!house_.category_of_object.emplace(index, take_number(line)).second) fail("this object occurs twice");
}

void HouseReader::check_counts() {
  const auto objects = static_cast<std::int64_t>(house_.category_of_object.size());
  const auto categories = static_cast<std::int64_t>(house_.categories.size());
  if (objects == promised_objects_ && categories == promised_categories_) return;
  house_.warnings.push_back(file_ + ": has " + std::to_string(objects) + " objects and " + std::to_string(categories) +
                            " categories, its header promises " + std::to_string(promised_objects_) + " and " +
                            std::to_string(promised_categories_) + "; it may be truncated");
}

std::set<std::string> class_names(const House& house) {
  std::set<std::string> names;
  for (const auto& [index, category] : house.categories) names.insert(category.mpcat40);
  return names;
}

}  // namespace

House parse_house(std::string_view text, const std::string& file) { return HouseReader(text, file).read(); }

Scene load_matterport(const AssetStore& store, const std::string& id, const LoadOptions& options) {
  const std::string house_file = full_name(store, id + ".house"), file = full_name(store, id + "_semantic.ply");
  const auto house_bytes = read_required(store, id + ".house");
  const House house = parse_house(as_text(house_bytes), house_file);
  ClassNames classes(options.labels, class_names(house));
  std::map<std::int64_t, ObjectLabel> objects;
  for (const auto& [object, index] : house.category_of_object) {
    const auto category = house.categories.find(index);
    const bool is_known = category != house.categories.end();
    objects[object] = {is_known ? classes.id_of(category->second.mpcat40) : std::uint16_t{0},
                       (is_known ? category->second.name : "object") + " " + std::to_string(object)};
  }
  Scene scene = load_object_ply(read_required(store, id + "_semantic.ply"), file, objects);
  scene.labels = classes.labels();
  scene.warnings.insert(scene.warnings.begin(), house.warnings.begin(), house.warnings.end());
  if (const auto warning = classes.warning()) scene.warnings.push_back(house_file + ": " + *warning);
  scene.warnings.push_back(file + ": the colours are those of its vertices; the textures of " + id +
                           ".glb are not used");
  finish_scene(scene, file);
  return scene;
}

}  // namespace lapis::simulator
