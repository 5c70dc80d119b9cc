#pragma once

#include <functional>
#include <string>
#include <vector>

namespace lapis::simulator {

enum class Verdict { kOk, kNote, kFail };

/// One row of the table that a validation prints.
struct Check {
  std::string name;
  Verdict verdict = Verdict::kOk;
  std::string figures{};               ///< one line
  std::vector<std::string> details{};  ///< one line each: the offenders, or the parts of the figures
};

/// Called with a line that names the current step.
using Progress = std::function<void(const std::string&)>;

/// A number as text, such as "1.25" for 1.2468 and two digits.
std::string decimal(double value, int digits);

}  // namespace lapis::simulator
