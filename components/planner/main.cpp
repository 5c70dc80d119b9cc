#include "common/runtime/component_main.hpp"

namespace lapis::planner {
class PlannerComponent;
}

int main(int argc, char** argv) { return lapis::runtime::run_component<lapis::planner::PlannerComponent>(argc, argv); }
