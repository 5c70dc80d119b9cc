// Gives every fuzzer its seeds, their beginnings, and copies with some bytes changed: the fuzzers of every build are
// built and run, if only for a moment.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "seeds.hpp"

// The names that CMakeLists.txt gives to LLVMFuzzerTestOneInput of each fuzzer.
#define LAPIS_FUZZERS(use)                                                                                      \
  use(catalog) use(gltf) use(hm3d) use(house) use(image) use(map) use(obj) use(octree) use(ply) use(pose_graph) \
      use(replica) use(scene) use(situation) use(slam) use(text) use(trajectory) use(zip)
#define LAPIS_DECLARE(name) int fuzz_##name(const std::uint8_t* data, std::size_t size);
extern "C" {
LAPIS_FUZZERS(LAPIS_DECLARE)
}

namespace lapis::simulator::fuzz {
namespace {

using Fuzzer = int (*)(const std::uint8_t*, std::size_t);

const std::map<std::string, Fuzzer>& fuzzers() {
#define LAPIS_ENTRY(name) {#name, fuzz_##name},
  static const std::map<std::string, Fuzzer> all{LAPIS_FUZZERS(LAPIS_ENTRY)};
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
  constexpr std::size_t kBeginnings = 16;
  constexpr int kSpoilt = 300;
  std::mt19937 random(1);
  for (const auto& [name, inputs] : seeds()) {
    const Fuzzer fuzzer = fuzzers().at(name);
    for (const Bytes& input : inputs) {
      SCOPED_TRACE(name);
      for (std::size_t i = 0; i <= kBeginnings; ++i) EXPECT_EQ(fuzzer(input.data(), input.size() * i / kBeginnings), 0);
      for (int i = 0; i < kSpoilt; ++i) {
        Bytes copy = input;
        for (std::size_t k = 0; k < 1 + random() % 4; ++k)
          copy[random() % copy.size()] = static_cast<std::uint8_t>(random());
        EXPECT_EQ(fuzzer(copy.data(), copy.size()), 0);
      }
    }
  }
}

}  // namespace
}  // namespace lapis::simulator::fuzz
