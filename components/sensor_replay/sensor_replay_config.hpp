#pragma once

#include <string>

#include "common/runtime/lockstep_driver.hpp"

namespace lapis::sensor_replay {

struct SensorReplayConfig {
  std::string dataset;
  std::string class_list;
  bool labels = true;
  double rate = 0.0;
  double start_s = 0.0;
  double duration_s = 0.0;
  int wait_for_readers = 0;
  double max_stamp_difference_s = 0.02;
  runtime::LockstepConfig lockstep{.stages = {"slam", "semantic_mapper", "evaluator"}};
  bool list = false;  ///< command line only
};

template <class Field>
void describe(Field& field, SensorReplayConfig& c) {
  field("dataset", c.dataset, config::anything(),
        "folder of the data set in the layout of the TUM RGB-D benchmark, with camera.yaml; or bag of rosbag2: its "
        "folder, "
        "or a .mcap or .db3");
  field("class_list", c.class_list, config::anything(),
        "CSV file with columns class_id,class,... that names the labels; empty: classes.csv of the data set, if it has "
        "one");
  field("labels", c.labels, config::anything(),
        "whether the label images of the data set are published; false: another process labels the images, such as "
        "segmenter");
  field("rate", c.rate, config::in_range(0.0, 100.0),
        "speed of the replay relative to the recording; 0: lock-step, in which no frame is lost");
  field("start_s", c.start_s, config::in_range(0.0, 1e6), "time that is skipped at the beginning of the recording [s]");
  field("duration_s", c.duration_s, config::in_range(0.0, 1e6),
        "length of the part of the recording that is played; 0: up to the end [s]");
  field("wait_for_readers", c.wait_for_readers, config::in_range(0, 100),
        "number of readers that the depth topic must have before the replay begins; only with a rate above 0");
  field("max_stamp_difference_s", c.max_stamp_difference_s, config::in_range(0.0, 1.0),
        "largest difference between the stamps of a colour image and its depth image or ground truth in the data set "
        "[s]");
}

}  // namespace lapis::sensor_replay
