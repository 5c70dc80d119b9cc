#include "common/runtime/run_component.hpp"
#include "slam/slam_component.hpp"

int main(int argc, char** argv) { return lapis::runtime::run_component<lapis::slam::SlamComponent>(argc, argv); }
