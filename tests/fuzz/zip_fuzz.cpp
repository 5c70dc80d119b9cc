#include "simulator/core/assets/zip_store.hpp"

#include <cstdlib>
#include <stdexcept>

#include "memory_file.hpp"

using lapis::simulator::ZipStore;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const lapis::fuzz::MemoryFile file(data, size);
  try {
    const ZipStore store(file.path());
    for (const auto& name : store.names()) {
      const auto bytes = store.read(name);
      if (bytes && bytes->size() > ZipStore::kMaxEntryBytes) std::abort();
    }
  } catch (const std::runtime_error&) {  // refused with a reason
  }
  return 0;
}
