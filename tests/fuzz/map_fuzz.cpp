// map.lapis, once as it is and once as the content of a file whose header is right.

#include <cstddef>
#include <cstdlib>
#include <string_view>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"
#include "common/mapping/file/map_file.hpp"

namespace {

using namespace lapis;

void decode(std::span<const std::uint8_t> bytes) {
  std::string error;
  const auto file = mapping::decode_map(bytes, error);
  if (file.has_value() != error.empty()) std::abort();
  if (!file) return;
  const auto again = mapping::decode_map(mapping::encode_map(*file), error);
  if (!again || !(again->map == file->map)) std::abort();
}

std::vector<std::uint8_t> with_right_header(std::span<const std::uint8_t> content) {
  const auto payload = files::zstd_compress(content, 1);
  files::ByteWriter checked, out;
  checked.u64(payload.size());
  checked.raw(payload);
  for (const char c : std::string_view("LAPISMAP")) out.u8(static_cast<std::uint8_t>(c));
  out.u32(1);
  out.u32(files::crc32(checked.bytes()));
  out.raw(checked.bytes());
  return out.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode({data, size});
  decode(with_right_header({data, size}));
  return 0;
}
