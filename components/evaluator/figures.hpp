#pragma once

#include <string>

namespace lapis::evaluator {

/// Draws figures/*.png of a run folder by the script beside this executable, and waits for it. A failure is a warning.
void draw_figures(std::string folder);

/// How a user draws them later.
std::string figures_command(const std::string& folder);

}  // namespace lapis::evaluator
