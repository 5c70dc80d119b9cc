#include "common/runtime/run_component.hpp"
#include "sensor_replay/sensor_replay_component.hpp"

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::sensor_replay::SensorReplayComponent>(argc, argv);
}
