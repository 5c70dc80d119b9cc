#include <iostream>

#include "common/runtime/run_component.hpp"
#include "slam/optimise_tool.hpp"
#include "slam/slam_component.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && lapis::slam::is_file_tool(argv[1])) {
    return lapis::slam::run_file_tool(argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::slam::SlamComponent>(argc, argv);
}
