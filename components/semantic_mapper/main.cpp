#include <iostream>

#include "common/runtime/run_component.hpp"
#include "semantic_mapper/file_tools.hpp"
#include "semantic_mapper/semantic_mapper_component.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && lapis::semantic_mapper::is_file_tool(argv[1])) {
    return lapis::semantic_mapper::run_file_tool(argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::semantic_mapper::SemanticMapperComponent>(argc, argv);
}
