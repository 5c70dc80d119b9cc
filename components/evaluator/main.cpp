#include <iostream>

#include "evaluator/command_line.hpp"

int main(int argc, char** argv) { return lapis::evaluator::run_file_tool(argc, argv, std::cout, std::cerr); }
