#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

namespace lapis::report {

/// Prints a result as JSON with all digits, or as text with one line per key. In text, an object becomes "key value"
/// pairs, an array of objects becomes a table, and a value that was not measured (null) becomes "-".
void print(std::ostream& out, const nlohmann::ordered_json& result, bool as_json);

}  // namespace lapis::report
