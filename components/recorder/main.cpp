#include "common/runtime/component_main.hpp"

namespace lapis::recorder {
class RecorderComponent;
}

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::recorder::RecorderComponent>(argc, argv);
}
