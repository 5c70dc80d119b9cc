#include <iostream>

#include "common/runtime/run_component.hpp"
#include "slam/optimise_tool.hpp"
#include "slam/slam_component.hpp"

int main(int argc, char** argv) {
  using lapis::slam::kFileTools;
  if (argc > 1 && lapis::runtime::is_file_tool(kFileTools, argv[1])) {
    return lapis::runtime::run_file_tool(kFileTools, argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::slam::SlamComponent>(argc, argv);
}
