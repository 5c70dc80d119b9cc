#include "common/runtime/component_main.hpp"

namespace lapis::sensor_replay {
class SensorReplayComponent;
}

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::sensor_replay::SensorReplayComponent>(argc, argv);
}
