#pragma once

#include <string>

#include "common/config/schema.hpp"

namespace lapis::evaluator {

struct EvaluatorConfig {
  std::string output_dir;
  std::string ground_truth_dir;
  double max_stamp_difference_s = 0.016;
  double label_wait_s = 1.5;
  double timeline_period_s = 1.0;
  bool figures = true;
};

template <class Field>
void describe(Field& field, EvaluatorConfig& c) {
  field("output_dir", c.output_dir, config::anything(),
        "run folder, in which the evaluator writes its files; must be set");
  field("ground_truth_dir", c.ground_truth_dir, config::anything(),
        "folder of the scene's ground truth that the simulator wrote (mesh.lapis, ideal.lapis, ...); empty: "
        "ground_truth in output_dir");
  field.moved("sensor_model.pass_gain", "semantic_mapper.sensor_model.miss_gain",
              "the evaluator reads it on /semantic_mapper/map_description");
  for (const char* former : {"resolution_m", "integration", "frame", "sensor_model"}) {
    field.moved(former, std::string("semantic_mapper.") + former,
                "the evaluator reads it on /semantic_mapper/map_description");
  }
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 0.1),
        "largest difference between the stamps of pose, true pose, depth, labels and camera info of a frame that the "
        "evaluator joins [s]");
  field("label_wait_s", c.label_wait_s, config::in_range(0.0, 3.0),
        "how much newer a frame of slam may be than one that still waits for its labels, where somebody publishes "
        "labels; then the older one is evaluated without them. At most 90 frames wait [s]");
  field("timeline_period_s", c.timeline_period_s, config::in_range(0.1, 3600.0),
        "shortest time between rows of timeline.csv, by the frames' time stamps [s]");
  field("figures", c.figures, config::anything(),
        "whether the evaluator draws figures/*.png at the end (needs python3 with matplotlib)");
}

}  // namespace lapis::evaluator
