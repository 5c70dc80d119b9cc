#include "common/runtime/run_component.hpp"
#include "semantic_mapper/semantic_mapper_component.hpp"

int main(int argc, char** argv) {
  return lapis::runtime::run_component<lapis::semantic_mapper::SemanticMapperComponent>(argc, argv);
}
