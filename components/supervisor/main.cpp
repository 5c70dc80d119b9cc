#include "supervisor/command_line.hpp"

int main(int argc, char** argv) { return lapis::supervisor::run(argc, argv); }
