#include "common/runtime/run_component.hpp"
#include "controller/controller_component.hpp"

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::controller::ControllerComponent>(argc, argv);
}
