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
  std::vector<std::string> details{};  ///< one line each: the offenders, or what the figures are made of
};

/// Called with what is being done, one line at a time.
using Progress = std::function<void(const std::string&)>;

/// "1.25" for 1.2468 and two digits.
std::string decimal(double value, int digits);

}  // namespace lapis::simulator
