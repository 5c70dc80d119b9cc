#include "common/runtime/component_main.hpp"

namespace lapis::simulator {
class SimulatorComponent;
}

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::simulator::SimulatorComponent>(argc, argv);
}
