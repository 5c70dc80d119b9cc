// frames.lapis, once as it is and once with checksums made right, so that what lies behind them is read, too. What
// could be read is continued.

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/mapping/wire/frame_codec.hpp"
#include "memory_file.hpp"
#include "semantic_mapper/core/frame_journal.hpp"

namespace {

using namespace lapis;
using semantic_mapper::FrameRecord;
using semantic_mapper::JournalSummary;

constexpr std::size_t kChecked = 20;  // bytes of the header before its checksum

struct Content {
  std::optional<JournalSummary> journal;
  std::vector<std::pair<FrameRecord, mapping::CompactFrame>> frames;
};

Content content_of(const std::string& path) {
  Content content;
  std::string error;
  const auto keep = [&content](const FrameRecord& record, mapping::CompactFrame samples) {
    content.frames.emplace_back(record, std::move(samples));
    return true;
  };
  content.journal = semantic_mapper::read_frame_journal(path, keep, error);
  if (content.journal.has_value() != error.empty()) std::abort();
  if (content.journal && content.journal->frames != content.frames.size()) std::abort();
  return content;
}

void decode(std::span<const std::uint8_t> bytes) {
  const fuzz::MemoryFile file(bytes.data(), bytes.size());
  const Content content = content_of(file.path());
  if (!content.journal) return;
  if (content.journal->end + content.journal->dropped != bytes.size()) std::abort();
  for (const auto& [record, samples] : content.frames) {
    if (!geometry::is_valid(record.T_map_keyframe) || !geometry::is_valid(samples.camera())) std::abort();
  }
  if (content.frames.empty()) return;
  semantic_mapper::FrameJournal again(file.path(), content.journal->session, content.journal->end);
  const auto& [record, samples] = content.frames.back();
  if (again.append(record, mapping::pack(samples))) std::abort();
  const Content continued = content_of(file.path());
  if (!continued.journal || continued.journal->dropped != 0) std::abort();
  if (continued.frames.size() != content.frames.size() + 1) std::abort();
}

std::vector<std::uint8_t> with_right_checksums(std::span<const std::uint8_t> bytes) {
  files::ByteWriter out;
  out.raw(bytes.first(std::min(kChecked, bytes.size())));
  out.u32(files::crc32(out.bytes()));
  bytes = bytes.subspan(std::min(kChecked + sizeof(std::uint32_t), bytes.size()));
  while (bytes.size() >= 8) {
    const std::size_t size = std::min<std::size_t>(files::ByteReader(bytes).u32(), bytes.size() - 8);
    const auto payload = bytes.subspan(8, size);
    out.u32(static_cast<std::uint32_t>(size));
    out.u32(files::crc32(payload));
    out.raw(payload);
    bytes = bytes.subspan(8 + size);
  }
  return out.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode({data, size});
  decode(with_right_checksums({data, size}));
  return 0;
}
