#include "common/runtime/run_component.hpp"
#include "simulator/simulator_component.hpp"

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::simulator::SimulatorComponent>(argc, argv);
}
