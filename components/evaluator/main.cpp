#include <iostream>

#include "common/runtime/run_component.hpp"
#include "evaluator/command_line.hpp"
#include "evaluator/evaluator_component.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && lapis::evaluator::is_file_tool(argv[1])) {
    return lapis::evaluator::run_file_tool(argc, argv, std::cout, std::cerr);
  }
  return lapis::runtime::run_component<lapis::evaluator::EvaluatorComponent>(argc, argv);
}
