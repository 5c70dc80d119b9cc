#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>

namespace lapis::report {

/// Prints a result: JSON with all digits, or text with a line per key. In text an object becomes "key value" pairs, an
/// array of objects a table, and a value that was not measured (null) "-".
void print(std::ostream& out, const nlohmann::ordered_json& result, bool as_json);

}  // namespace lapis::report
