#include "simulator/core/loaders/hm3d.hpp"

#include "check_scene.hpp"
#include "fuzz_files.hpp"

using lapis::simulator::fuzz::Bytes;
using lapis::simulator::fuzz::FuzzStore;

namespace {

std::optional<std::map<std::string, std::string>> read_mapping(const FuzzStore& store) {
  const std::optional<Bytes> bytes = store.read("a.tsv");
  if (!bytes) return std::nullopt;
  return lapis::simulator::parse_hm3d_mapping({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, "a.tsv");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(data, size, {"a.semantic.txt", "a.tsv", "a.semantic.glb", "a.glb"});
  return lapis::simulator::fuzz::check_loading([&] { return load_hm3d(store, "a", read_mapping(store), {{}, 16}); });
}
