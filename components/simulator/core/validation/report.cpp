#include "simulator/core/validation/report.hpp"

#include <iomanip>
#include <sstream>

namespace lapis::simulator {

std::string decimal(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

}  // namespace lapis::simulator
