#include "common/runtime/run_component.hpp"
#include "planner/planner_component.hpp"

int main(int argc, char** argv) { return lapis::runtime::run_component<lapis::planner::PlannerComponent>(argc, argv); }
