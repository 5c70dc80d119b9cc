#include "common/runtime/component_main.hpp"

namespace lapis::segmenter {
class SegmenterComponent;
}

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::segmenter::SegmenterComponent>(argc, argv);
}
