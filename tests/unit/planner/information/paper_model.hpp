#pragma once

#include <cmath>
#include <vector>

#include "common/mapping/model/sensor_model.hpp"

namespace lapis::planner::test {

/// A model with the paper's increments, by which voxels that were never observed have these log-odds of the classes.
inline mapping::SensorModel paper_model_with_prior(const std::vector<double>& chi) {
  double sum = 0.0;
  for (const double y : chi) sum += std::exp(y);
  std::vector<double> shares;
  for (const double y : chi) shares.push_back(std::exp(y) / sum);
  mapping::SensorModel model = mapping::paper_sensor_model(shares);
  model.prior_occupied = sum / (1.0 + sum);
  return model;
}

}  // namespace lapis::planner::test
