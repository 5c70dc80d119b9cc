#pragma once

#include <functional>
#include <string>

namespace lapis::evaluator {

/// Draws figures/*.png of a run folder by the script beside this executable, and waits for it, but not longer than
/// until `is_in_a_hurry`. A failure is a warning.
void draw_figures(std::string folder, const std::function<bool()>& is_in_a_hurry);

/// How a user draws them later.
std::string figures_command(const std::string& folder);

}  // namespace lapis::evaluator
