#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace lapis::config {

/// A configuration that cannot be used; the message names the path, the value, the bound and, if there is one, the
/// source.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using Words = std::vector<std::string>;
using Numbers = std::vector<double>;

/// The allowed values: a closed interval for numbers, a list of words for text, or anything.
struct Bound {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  Words words;
  /// Where the words are listed, for documents that must not repeat a list that may grow; empty: documents list the
  /// words.
  std::string listed_in = {};

  /// "0.1 to 20", "a | b", or empty when everything is allowed.
  std::string text() const;
  /// As text(), for documents: refers to `listed_in` when that is set.
  std::string document() const { return listed_in.empty() ? text() : listed_in; }
  /// NaN is never allowed.
  bool allows(double number) const { return number >= lowest && number <= highest; }
  bool allows(const std::string& word) const;
  /// Why a value is refused: " is out of range, allowed is 0.1 to 20".
  std::string refusal() const;
};

Bound in_range(double lowest, double highest);
Bound at_least(double lowest);
Bound one_of(Words words, std::string listed_in = "");
Bound anything();

/// When a value takes effect: almost all are read once, at start; others are obeyed when they change (a component with
/// such keys has reconfigure(): common/runtime/run_component.hpp).
enum class Change { kAtStart, kAtRunTime };

/// One configuration value: its path, its storage, its allowed values and its meaning.
struct Entry {
  std::string path;  ///< "slam.noise.max_depth_m"
  std::variant<bool*, int*, std::int64_t*, double*, std::string*, Words*, Numbers*> value;
  Bound bound;
  std::string meaning;
  Change change = Change::kAtStart;

  /// The meaning, and whether the value may change at run time, for documents.
  std::string remark() const { return meaning + (change == Change::kAtRunTime ? "; may change at run time" : ""); }
};

/// A condition between several keys: whether it holds, and its text, which names the keys by their full paths.
struct Rule {
  bool holds;
  std::string text;
};
using Rules = std::vector<Rule>;

/// A key, or a section with all its keys, that older configurations may contain.
struct FormerKey {
  std::string path;    ///< "planner.sensor_model"
  std::string now;     ///< its full path today; empty: it was removed
  std::string remark;  ///< why, or what replaces it; may be empty
};

/// Collects the entries of configuration structs. A struct takes part by a free function in its own namespace,
///
///   template <class Field> void describe(Field& field, TrackerConfig& c) {
///     field("max_depth_m", c.max_depth_m, config::in_range(0.1, 20.0), "measurements beyond this are ignored");
///   }
///
/// which alone drives loading, validation, printing and the README table. The structs must outlive the schema.
class Schema {
 public:
  template <class Value>
  void operator()(const std::string& name, Value& value, Bound bound, std::string meaning,
                  Change change = Change::kAtStart) {
    entries_.push_back({prefix_ + name, &value, std::move(bound), std::move(meaning), change});
  }

  /// A nested struct.
  template <class Struct>
  void operator()(const std::string& name, Struct& nested) {
    const std::string outer = prefix_;
    prefix_ += name + ".";
    describe(*this, nested);
    prefix_ = outer;
  }

  /// A renamed key or section: an error for the old name gives the full path of the new one.
  void moved(const std::string& former, std::string now, std::string remark = "") {
    former_.push_back({prefix_ + former, std::move(now), std::move(remark)});
  }
  /// A removed key or section, and the reason.
  void removed(const std::string& former, std::string remark) { moved(former, "", std::move(remark)); }

  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<FormerKey>& former() const { return former_; }

 private:
  std::string prefix_;
  std::vector<Entry> entries_;
  std::vector<FormerKey> former_;
};

/// Throws Error unless all values are within their bounds: "fan.length_m: 9 is out of range, allowed is 0.5 to 5".
void check(const Schema& schema);
/// The same for a described struct that does not come from a configuration.
template <class Struct>
void check(const std::string& section, Struct values) {
  Schema schema;
  schema(section, values);
  check(schema);
}

/// True when the text is valid UTF-8 without NUL bytes.
bool is_utf8(std::string_view text);
/// Text as a double-quoted YAML scalar, which is valid JSON, too. A byte that is not valid UTF-8 becomes the escape of
/// the character with its number.
std::string quoted(const std::string& text);
/// The entry's current value as YAML text.
std::string to_text(const Entry& entry);
/// A README table: key, default, allowed, meaning.
std::string to_markdown(const Schema& schema);

}  // namespace lapis::config
