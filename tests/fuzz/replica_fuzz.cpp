#include "simulator/core/loaders/replica.hpp"

#include "check_scene.hpp"
#include "fuzz_files.hpp"

using lapis::simulator::fuzz::FuzzStore;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(data, size, {"info_semantic.json", "mesh_semantic.ply"});
  return lapis::simulator::fuzz::check_loading([&] { return load_replica(store, ""); });
}
