// Gives every fuzzer its seeds, their beginnings, and copies with some bytes changed: the fuzzers of every build are
// built and run, if only for a moment.

#include <gtest/gtest.h>

#include "replay.hpp"
#include "seeds.hpp"

// The names that CMakeLists.txt gives to LLVMFuzzerTestOneInput of each fuzzer.
#define LAPIS_FUZZERS(use)                                                                                           \
  use(bag) use(catalog) use(frames) use(gltf) use(hm3d) use(house) use(image) use(map) use(obj) use(octree) use(ply) \
      use(pose_graph) use(replica) use(scene) use(situation) use(slam) use(text) use(trajectory) use(zip)
#define LAPIS_DECLARE(name) int fuzz_##name(const std::uint8_t* data, std::size_t size);
extern "C" {
LAPIS_FUZZERS(LAPIS_DECLARE)
}

namespace lapis::simulator::fuzz {
namespace {

const std::map<std::string, lapis::fuzz::Fuzzer>& fuzzers() {
#define LAPIS_ENTRY(name) {#name, fuzz_##name},
  static const std::map<std::string, lapis::fuzz::Fuzzer> all{LAPIS_FUZZERS(LAPIS_ENTRY)};
  return all;
}

TEST(FuzzReplay, EveryFuzzerHasSeeds) {
  const Seeds all = seeds();
  EXPECT_EQ(all.size(), fuzzers().size());
  for (const auto& [name, inputs] : all) {
    EXPECT_TRUE(fuzzers().contains(name)) << name;
    EXPECT_FALSE(inputs.empty()) << name;
  }
}

TEST(FuzzReplay, SeedsAndSpoiltCopiesDoNoHarm) {
  for (const auto& [name, inputs] : seeds()) {
    SCOPED_TRACE(name);
    lapis::fuzz::replay(fuzzers().at(name), inputs);
  }
}

}  // namespace
}  // namespace lapis::simulator::fuzz
