#include <iostream>

#include "common/runtime/component_main.hpp"
#include "evaluator/command_line.hpp"

namespace lapis::evaluator {
class EvaluatorComponent;
}

int main(int argc, char** argv) {
  using lapis::evaluator::kFileTools;
  if (argc > 1 && lapis::runtime::is_file_tool(kFileTools, argv[1])) {
    return lapis::runtime::run_file_tool(kFileTools, argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::evaluator::EvaluatorComponent>(argc, argv);
}
