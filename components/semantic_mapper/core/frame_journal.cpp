#include "semantic_mapper/core/frame_journal.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "common/files/atomic_file.hpp"
#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"
#include "common/mapping/wire/frame_codec.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr std::string_view kJournalMagic = "LAPISFRM";
constexpr std::uint32_t kJournalVersion = 1;
constexpr std::size_t kJournalHeaderBytes = 24;
constexpr std::size_t kRecordHeaderBytes = 8;
constexpr std::uint32_t kMaxPayloadBytes = std::uint32_t{64} << 20;
/// A camera of 7,000 x 7,000 pixels with labels and confidence, none of them left out, has less.
constexpr std::size_t kMaxSampleBytes = std::size_t{256} << 20;
constexpr std::int64_t kLastStampNs = 2'147'483'647'999'999'999;  // of messages, whose seconds have 32 bits
constexpr std::uint8_t kIsKeyframe = 1, kIsHeld = 2;

/// Why a journal cannot hold a frame; empty when it can.
std::string find_fault(const FrameRecord& record, std::span<const std::uint8_t> packed) {
  const auto is_sigma = [](double value) { return std::isfinite(value) && value >= 0.0; };
  const std::int64_t stamp_ns = record.stamp.nanoseconds;
  if (stamp_ns < 0 || stamp_ns > kLastStampNs) return "its stamp is out of range";
  for (const geometry::Pose& T : {record.T_keyframe_camera, record.T_map_keyframe, record.T_map_previous})
    if (!geometry::is_valid(T)) return "its pose is not valid";
  if (!is_sigma(record.drift.position_m) || !is_sigma(record.drift.rotation_rad)) return "its drift is no sigma";
  const auto size = files::zstd_content_size(packed);
  if (!size) return "its samples are not packed";
  if (*size > kMaxSampleBytes) return "its samples take more than 256 MB";
  return "";
}

void write_pose(const geometry::Pose& T, files::ByteWriter& out) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) out.f64(T(row, column));
}

geometry::Pose read_pose(files::ByteReader& in) {
  geometry::Pose T = geometry::Pose::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) T(row, column) = in.f64();
  return T;
}

std::vector<std::uint8_t> encode_payload(const FrameRecord& record, std::span<const std::uint8_t> packed) {
  files::ByteWriter out;
  out.u64(static_cast<std::uint64_t>(record.stamp.nanoseconds));
  out.u64(record.keyframe_id);
  write_pose(record.T_keyframe_camera, out);
  write_pose(record.T_map_keyframe, out);
  out.u64(record.known_since);
  out.u64(record.previous_id);
  write_pose(record.T_map_previous, out);
  out.u64(record.graph_version);
  out.f64(record.drift.position_m);
  out.f64(record.drift.rotation_rad);
  out.u8(static_cast<std::uint8_t>((record.is_keyframe ? kIsKeyframe : 0) | (record.is_held ? kIsHeld : 0)));
  out.raw(packed);
  return out.take();
}

/// Gives the frame of an undamaged record to `visit`; false when it is impossible or refused.
bool visit_payload(std::span<const std::uint8_t> payload, const JournalVisitor& visit) {
  files::ByteReader in(payload);
  FrameRecord record;
  record.stamp.nanoseconds = static_cast<std::int64_t>(in.u64());
  record.keyframe_id = in.u64();
  record.T_keyframe_camera = read_pose(in);
  record.T_map_keyframe = read_pose(in);
  record.known_since = in.u64();
  record.previous_id = in.u64();
  record.T_map_previous = read_pose(in);
  record.graph_version = in.u64();
  record.drift.position_m = in.f64();
  record.drift.rotation_rad = in.f64();
  const std::uint8_t flags = in.u8();
  record.is_keyframe = (flags & kIsKeyframe) != 0;
  record.is_held = (flags & kIsHeld) != 0;
  const std::span<const std::uint8_t> packed = in.raw(in.remaining());
  if (!in.is_good() || flags > (kIsKeyframe | kIsHeld) || !find_fault(record, packed).empty()) return false;
  auto samples = mapping::unpack_frame(packed);
  return samples && visit(record, std::move(*samples));
}

std::vector<std::uint8_t> encode_header(std::int64_t session) {
  files::ByteWriter out;
  for (const char c : kJournalMagic) out.u8(static_cast<std::uint8_t>(c));
  out.u32(kJournalVersion);
  out.u64(static_cast<std::uint64_t>(session));
  out.u32(files::crc32(out.bytes()));
  return out.take();
}

bool begins_as_journal(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kJournalMagic.size() && std::equal(kJournalMagic.begin(), kJournalMagic.end(), bytes.begin());
}

/// Session of the file; nothing, with the reason in `error`, when it cannot be read.
std::optional<std::int64_t> decode_header(std::span<const std::uint8_t> bytes, std::string& error) {
  if (!begins_as_journal(bytes)) {
    error = "is no journal of frames";
    return std::nullopt;
  }
  files::ByteReader in(bytes.subspan(kJournalMagic.size()));
  const std::uint32_t version = in.u32();
  const auto session = static_cast<std::int64_t>(in.u64());
  const std::uint32_t checksum = in.u32();
  if (!in.is_good()) {
    error = "is cut off";
  } else if (version != kJournalVersion) {
    error = "has format version " + std::to_string(version) + ", this program reads " + std::to_string(kJournalVersion);
  } else if (checksum != files::crc32(bytes.first(kJournalHeaderBytes - sizeof checksum))) {
    error = "is damaged: its header has another checksum than when it was written";
  } else {
    return session;
  }
  return std::nullopt;
}

/// The next bytes of a file, less when it ends before.
std::vector<std::uint8_t> read_bytes(std::istream& in, std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

/// Payload of the next record; nothing when the `rest` of the file does not hold an undamaged one.
std::optional<std::vector<std::uint8_t>> read_payload(std::istream& in, std::uint64_t rest) {
  const std::vector<std::uint8_t> header = read_bytes(in, kRecordHeaderBytes);
  files::ByteReader reader(header);
  const std::uint32_t size = reader.u32(), checksum = reader.u32();
  if (!reader.is_good() || size > kMaxPayloadBytes || size > rest - kRecordHeaderBytes) return std::nullopt;
  auto payload = read_bytes(in, size);
  if (payload.size() != size || files::crc32(payload) != checksum) return std::nullopt;
  return payload;
}

}  // namespace

std::optional<JournalSummary> read_frame_journal(const std::string& path, const JournalVisitor& visit,
                                                 std::string& error) {
  std::error_code problem;
  const std::uintmax_t size = std::filesystem::file_size(path, problem);
  std::ifstream in;
  if (!problem) in.open(path, std::ios::binary);
  if (!in.is_open()) {
    error =
        path + ": cannot be opened: " + (problem ? problem : std::error_code(errno, std::generic_category())).message();
    return std::nullopt;
  }
  const auto session = decode_header(read_bytes(in, kJournalHeaderBytes), error);
  if (!session) {
    error = path + ": " + error;
    return std::nullopt;
  }
  JournalSummary journal{*session, 0, kJournalHeaderBytes, 0};
  while (journal.end + kRecordHeaderBytes <= size) {
    const auto payload = read_payload(in, size - journal.end);
    if (!payload || !visit_payload(*payload, visit)) break;
    journal.end += kRecordHeaderBytes + payload->size();
    ++journal.frames;
  }
  if (in.bad()) {
    error = path + ": cannot be read";
    return std::nullopt;
  }
  journal.dropped = size - journal.end;
  return journal;
}

bool is_frame_journal(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return begins_as_journal(read_bytes(in, kJournalMagic.size()));
}

FrameJournal::FrameJournal(std::string path, std::int64_t session, std::uint64_t end)
    : path_(std::move(path)), session_(session), end_(end) {}

FrameJournal::~FrameJournal() { close(); }

void FrameJournal::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void FrameJournal::remove() {
  close();
  std::error_code error;
  std::filesystem::remove(path_, error);
  end_ = 0;
}

std::string FrameJournal::reason(const char* what) const {
  return path_ + ": " + what + ": " + std::generic_category().message(errno);
}

/// Opens the file and removes what follows its last whole frame; does nothing when that was done before.
std::optional<std::string> FrameJournal::open() {
  if (file_ >= 0) return std::nullopt;
  if (end_ == 0) {
    if (auto problem = files::replace_file(path_, encode_header(session_))) return problem;
    end_ = kJournalHeaderBytes;
  }
  file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) return reason("cannot be opened");
  if (::ftruncate(file_, static_cast<off_t>(end_)) == 0) return std::nullopt;
  auto problem = reason("cannot be cut off");
  close();
  return problem;
}

std::optional<std::string> FrameJournal::write(std::span<const std::uint8_t> bytes) {
  for (std::uint64_t at = end_; !bytes.empty();) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return reason("cannot be written");
    at += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return std::nullopt;
}

std::optional<std::string> FrameJournal::append(const FrameRecord& record, std::span<const std::uint8_t> packed) {
  if (const std::string fault = find_fault(record, packed); !fault.empty()) return path_ + ": takes no frame: " + fault;
  const std::vector<std::uint8_t> payload = encode_payload(record, packed);
  if (payload.size() > kMaxPayloadBytes) return path_ + ": takes no frame: it has more than 64 MB";
  files::ByteWriter out;
  out.u32(static_cast<std::uint32_t>(payload.size()));
  out.u32(files::crc32(payload));
  out.raw(payload);
  auto problem = open();
  if (problem) return problem;
  problem = write(out.bytes());
  if (!problem) {
    end_ += out.bytes().size();
  } else if (::ftruncate(file_, static_cast<off_t>(end_)) != 0) {
    close();  // the next frame tries again
  }
  return problem;
}

}  // namespace lapis::semantic_mapper
