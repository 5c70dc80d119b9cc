// As replay_test.cpp, for the fuzzer that needs Fast DDS.

#include "message_seeds.hpp"
#include "message_types.hpp"
#include "replay.hpp"

// The name that CMakeLists.txt gives to LLVMFuzzerTestOneInput.
extern "C" int fuzz_message(const std::uint8_t* data, std::size_t size);

namespace lapis::fuzz {
namespace {

TEST(FuzzReplay, DamagedMessagesDoNoHarm) {
  const auto seeds = message_seeds();
  EXPECT_EQ(seeds.size(), 2 * message_count());
  replay(fuzz_message, seeds);
}

}  // namespace
}  // namespace lapis::fuzz
