#pragma once

#include <functional>
#include <string>

namespace lapis::evaluator {

/// Draws figures/*.png of a run folder with the script next to this executable. Waits for the script, but terminates it
/// when `is_in_a_hurry`. A failure gives a warning.
void draw_figures(std::string folder, const std::function<bool()>& is_in_a_hurry);

/// Text that tells the user how to draw the figures later.
std::string figures_command(const std::string& folder);

}  // namespace lapis::evaluator
