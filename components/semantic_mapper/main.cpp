#include <iostream>

#include "common/runtime/component_main.hpp"
#include "semantic_mapper/file_tools.hpp"

namespace lapis::semantic_mapper {
class SemanticMapperComponent;
}

int main(int argc, char** argv) {
  using lapis::semantic_mapper::kFileTools;
  if (argc > 1 && lapis::runtime::is_file_tool(kFileTools, argv[1])) {
    return lapis::runtime::run_file_tool(kFileTools, argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::semantic_mapper::SemanticMapperComponent>(argc, argv);
}
