#include "common/runtime/component_main.hpp"

namespace lapis::controller {
class ControllerComponent;
}

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::controller::ControllerComponent>(argc, argv);
}
