// Files of bags (MCAP, SQLite, metadata.yaml, all compressed or not), from a file without a name.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "common/bags/bag_metadata.hpp"
#include "common/bags/bag_reader.hpp"
#include "common/bags/chunk_codec.hpp"

namespace {

using namespace lapis;

constexpr int kMostErrors = 20;

void read_all(const std::string& path) {
  bags::BagReader reader(path);
  const std::size_t channels = reader.contents().channels.size();
  for (int errors = 0; errors < kMostErrors;) {
    try {
      const auto message = reader.next();
      if (!message) return;
      if (message->channel >= channels) std::abort();
    } catch (const std::runtime_error&) {
      ++errors;
    }
  }
}

template <class Job>
void attempt(const Job& job) {
  try {
    job();
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = ::memfd_create("bag", MFD_CLOEXEC);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  attempt([&] { read_all(path); });
  attempt([&] { bags::read_metadata(path); });
  attempt([&] { bags::unpack("lz4", {data, size}, 100'000); });
  attempt([&] { bags::unpack_zstd({data, size}); });
  ::close(file);
  return 0;
}
