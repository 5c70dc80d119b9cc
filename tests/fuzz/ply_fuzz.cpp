#include "simulator/core/loaders/labelled_ply.hpp"

#include "check_scene.hpp"
#include "fuzz_files.hpp"

using lapis::simulator::fuzz::FuzzStore;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(data, size, {"a.ply", "classes.csv", "instances.csv"});
  return lapis::simulator::fuzz::check_loading([&] { return load_labelled_ply(store, "a.ply", {}); });
}
