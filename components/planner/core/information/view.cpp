#include "planner/core/information/view.hpp"

#include <stdexcept>
#include <string>

namespace lapis::planner {
namespace {

void require(bool is_good, const std::string& what) {
  if (!is_good) throw std::runtime_error("view: " + what);
}

}  // namespace

View::View(const ViewConfig& config) : config_(config) {
  const geometry::PinholeCamera& camera = config.camera;
  require(is_valid(camera), "camera must have a positive size and positive focal lengths");
  require(config.columns >= 1 && config.columns <= 4096, "columns must be in [1, 4096]");
  require(config.rows >= 1 && config.rows <= 4096, "rows must be in [1, 4096]");
  require(config.range_m > 0.0 && config.range_m <= 100.0, "range_m must be in (0, 100]");
  require(config.min_reach >= 0.0 && config.min_reach < 1.0, "min_reach must be in [0, 1)");
  for (int row = 0; row < config.rows; ++row) {
    for (int column = 0; column < config.columns; ++column) {
      const double u = (column + 0.5) * camera.width / config.columns - 0.5;
      const double v = (row + 0.5) * camera.height / config.rows - 0.5;
      directions_.push_back(camera.unproject(u, v, 1.0).normalized());
    }
  }
  for (const double u : {-0.5, camera.width - 0.5})
    for (const double v : {-0.5, camera.height - 0.5}) corners_.push_back(camera.unproject(u, v, config.range_m));
}

}  // namespace lapis::planner
