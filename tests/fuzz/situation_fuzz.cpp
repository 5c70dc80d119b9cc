// A planner's situation file, once as it is and once with the right checksum.

#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "planner/core/replay/situation_file.hpp"

namespace {

using namespace lapis;

constexpr std::size_t kHeader = 16;  // magic, version, checksum

void decode(std::span<const std::uint8_t> bytes) {
  std::string error;
  const auto situation = planner::decode_situation(bytes, error);
  if (situation.has_value() != error.empty()) std::abort();
  if (!situation) return;
  const auto again = planner::encode_situation(*situation);
  if (!planner::decode_situation(again, error)) std::abort();
}

std::vector<std::uint8_t> with_right_checksum(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kHeader) return {};
  files::ByteWriter out;
  out.raw(bytes);
  out.set_u32(kHeader - 4, files::crc32(bytes.subspan(kHeader)));
  return out.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode({data, size});
  decode(with_right_checksum({data, size}));
  return 0;
}
