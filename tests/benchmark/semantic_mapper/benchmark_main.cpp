// CPU time of the core, one thread.

#include <benchmark/benchmark.h>

#include "tests/benchmark/semantic_mapper/benchmarks.hpp"

int main(int argc, char** argv) {
  lapis::semantic_mapper::benchmarks::register_insert();
  lapis::semantic_mapper::benchmarks::register_corrections();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
