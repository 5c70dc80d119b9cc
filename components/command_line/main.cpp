#include "command_line/command_line.hpp"

int main(int argc, char** argv) { return lapis::command_line::run(argc, argv); }
