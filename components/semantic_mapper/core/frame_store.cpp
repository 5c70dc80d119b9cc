#include "semantic_mapper/core/frame_store.hpp"

#include <utility>

#include "common/mapping/wire/frame_codec.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr const char* kUnreadable = "the temporary file cannot be read any more";

}  // namespace

void FrameStore::add(const mapping::CompactFrame& frame, const mapping::FrameVotes& votes) {
  Record record;
  record.frame.memory = mapping::pack(frame);
  record.votes.memory = mapping::pack(votes);
  memory_bytes_ += record.frame.memory.size() + record.votes.memory.size();
  records_.push_back(std::move(record));
  keep_budget();
}

std::optional<std::vector<std::uint8_t>> FrameStore::read(const Bytes& bytes) const {
  return bytes.disk ? file_.read(*bytes.disk) : bytes.memory;
}

std::optional<mapping::CompactFrame> FrameStore::frame(std::size_t index) {
  const auto bytes = read(records_[index].frame);
  auto frame = bytes ? mapping::unpack_frame(*bytes) : std::nullopt;
  if (!frame) give_up(records_[index], kUnreadable);
  return frame;
}

std::optional<mapping::FrameVotes> FrameStore::votes(std::size_t index) {
  const auto bytes = read(records_[index].votes);
  auto votes = bytes ? mapping::unpack_votes(*bytes) : std::nullopt;
  if (!votes) give_up(records_[index], kUnreadable);
  return votes;
}

std::optional<std::vector<std::uint8_t>> FrameStore::packed_frame(std::size_t index) const {
  return has(index) ? read(records_[index].frame) : std::nullopt;
}

bool FrameStore::replace_votes(std::size_t index, const mapping::FrameVotes& votes) {
  Record& record = records_[index];
  drop(record.votes);
  record.votes.memory = mapping::pack(votes);
  memory_bytes_ += record.votes.memory.size();
  if (index < first_in_memory_ && !spill(record.votes)) give_up(record, problem_);
  keep_budget();
  return !record.is_let_go;
}

/// Moves bytes from memory to disk; false, with the reason in problem_, when there is no room.
bool FrameStore::spill(Bytes& bytes) {
  if (!file_.is_open()) {
    if (const auto reason = file_.open(config_.spill_dir)) {
      problem_ = *reason;
      return false;
    }
  }
  bytes.disk = file_.write(bytes.memory, problem_);
  if (!bytes.disk) return false;
  memory_bytes_ -= bytes.memory.size();
  bytes.memory = {};
  return true;
}

void FrameStore::drop(Bytes& bytes) {
  memory_bytes_ -= bytes.memory.size();
  if (bytes.disk) file_.release(*bytes.disk);
  bytes = {};
}

void FrameStore::give_up(Record& record, std::string problem) {
  drop(record.frame);
  drop(record.votes);
  let_go_ += record.is_let_go ? 0 : 1;
  record.is_let_go = true;
  problem_ = std::move(problem);
}

void FrameStore::keep_budget() {
  const std::size_t budget = static_cast<std::size_t>(config_.memory_mb) << 20;
  for (; memory_bytes_ > budget && first_in_memory_ < records_.size(); ++first_in_memory_) {
    Record& record = records_[first_in_memory_];
    if (!record.is_let_go && !(spill(record.frame) && spill(record.votes))) give_up(record, problem_);
  }
}

}  // namespace lapis::semantic_mapper
