#include "simulator/core/loaders/semantics_json.hpp"

#include "check_scene.hpp"
#include "fuzz_files.hpp"

using lapis::simulator::fuzz::FuzzStore;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(data, size, {"a.glb", "semantics.json"});
  return lapis::simulator::fuzz::check_loading([&] { return load_model_scene(store, "a.glb", {{}, 16}); });
}
