#pragma once

#include <string>

#include "common/config/schema.hpp"

namespace lapis::segmenter {

struct SegmenterConfig {
  std::string model;
  int threads = 1;
};

template <class Field>
void describe(Field& field, SegmenterConfig& c) {
  field("model", c.model, config::anything(),
        "YAML file that names the network, what it takes and gives, and its classes (components/segmenter/README.md)");
  field("threads", c.threads, config::in_range(1, 64), "number of threads that the network uses");
}

}  // namespace lapis::segmenter
