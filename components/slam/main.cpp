#include <iostream>

#include "common/runtime/component_main.hpp"
#include "slam/optimise_tool.hpp"

namespace lapis::slam {
class SlamComponent;
}

int main(int argc, char** argv) {
  using lapis::slam::kFileTools;
  if (argc > 1 && lapis::runtime::is_file_tool(kFileTools, argv[1])) {
    return lapis::runtime::run_file_tool(kFileTools, argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::slam::SlamComponent>(argc, argv);
}
