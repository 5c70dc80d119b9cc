#pragma once

#include <optional>
#include <string>

#include "sensor_replay/core/tum_dataset.hpp"

namespace lapis::sensor_replay {

/// Length of the true path through the frames that have a true pose [m]; empty with fewer than two such frames.
std::optional<double> path_length_m(const TumDataset& dataset);

/// Summary of a data set for `--list`: one line per fact, each with a newline at its end.
std::string describe(const TumDataset& dataset);

}  // namespace lapis::sensor_replay
