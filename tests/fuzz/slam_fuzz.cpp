// slam.lapis, once as it is and once with sizes and checksums made right, so that what lies behind them is read, too.

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "slam/core/files/slam_file.hpp"

namespace {

using namespace lapis;

constexpr std::size_t kHeader = 12;         // magic, version
constexpr std::size_t kSectionHeader = 16;  // tag, checksum, size

void decode(std::span<const std::uint8_t> bytes) {
  std::string error;
  const auto file = slam::decode_slam_file(bytes, error);
  if (file.has_value() != error.empty()) std::abort();
  if (!file) return;
  const slam::Map map = slam::restore_map(file->state);
  if (map.keyframes().size() != file->state.keyframes.size()) std::abort();
  const auto again = slam::encode_slam_file(*file);
  if (!slam::decode_slam_file(again, error)) std::abort();
}

std::vector<std::uint8_t> with_right_checksums(std::span<const std::uint8_t> bytes) {
  files::ByteWriter out;
  out.raw(bytes.first(std::min(kHeader, bytes.size())));
  bytes = bytes.subspan(out.bytes().size());
  while (bytes.size() >= kSectionHeader) {
    const std::uint64_t size = files::ByteReader(bytes.subspan(8)).u64();
    const auto content = bytes.subspan(kSectionHeader, std::min<std::size_t>(size, bytes.size() - kSectionHeader));
    files::ByteWriter checked;
    checked.u64(content.size());
    checked.raw(content);
    out.raw(bytes.first(4));
    out.u32(files::crc32(checked.bytes()));
    out.raw(checked.bytes());
    bytes = bytes.subspan(kSectionHeader + content.size());
  }
  return out.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode({data, size});
  decode(with_right_checksums({data, size}));
  return 0;
}
