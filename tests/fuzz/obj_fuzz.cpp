#include "simulator/core/assets/obj.hpp"

#include <cstdlib>
#include <stdexcept>

#include "fuzz_files.hpp"

using lapis::simulator::fuzz::FuzzStore;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzStore store(data, size, {"a.obj", "a.mtl", "a.png"});
  try {
    const auto model = lapis::simulator::read_obj(store, "a.obj", 16);
    if (!problem_of(model.mesh).empty()) std::abort();
  } catch (const std::runtime_error&) {  // refused with a reason
  }
  return 0;
}
