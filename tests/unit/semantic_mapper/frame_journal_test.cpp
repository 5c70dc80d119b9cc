// Frames on disk: what a journal gives back after kills, damage and full disks, and the map that is built from it.
#include "semantic_mapper/core/frame_journal.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files/atomic_file.hpp"
#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"
#include "common/mapping/wire/frame_codec.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/synthetic_room.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kSession = 1'700'000'000'000'000'001;
constexpr std::size_t kHeaderSize = 24, kRecordHeaderSize = 8;
// Of fields in the payload of a record.
constexpr std::size_t kStampAt = 0, kRotationAt = 16, kPoseAt = 112, kPreviousAt = 224, kDriftAt = 328, kFlagsAt = 344;
constexpr std::size_t kSamplesAt = 345;

struct KeptFrame {
  FrameRecord record;
  mapping::CompactFrame samples;
};

Pose random_pose(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> number(-size, size);
  geometry::Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = number(random);
  return geometry::se3_exp(xi);
}

KeptFrame tiny_frame(std::mt19937& random) {
  const geometry::PinholeCamera camera{6, 4, 5, 5, 2.5, 1.5};
  geometry::DepthImage depth(camera.width, camera.height);
  for (float& d : depth.pixels) d = static_cast<float>(random() % 5000) * 1e-3f;
  const geometry::LabelImage labels(camera.width, camera.height, static_cast<std::uint16_t>(random() % 40));
  FrameRecord record;
  record.stamp = {static_cast<std::int64_t>(random())};
  record.keyframe_id = random();
  record.T_keyframe_camera = random_pose(random, 2.0);
  record.T_map_keyframe = random_pose(random, 2.0);
  record.known_since = random();
  record.previous_id = random();
  record.T_map_previous = random_pose(random, 2.0);
  record.graph_version = random();
  record.drift = {static_cast<double>(random() % 3) * 0.1, static_cast<double>(random() % 3) * 0.01};
  record.is_keyframe = random() % 2 == 0;
  record.is_held = random() % 2 == 0;
  std::string error;
  return {record, mapping::CompactFrame::make(camera, depth, &labels, {2, 40}, error).value()};
}

void expect_same(const KeptFrame& a, const KeptFrame& b) {
  EXPECT_EQ(a.record.stamp, b.record.stamp);
  EXPECT_EQ(a.record.keyframe_id, b.record.keyframe_id);
  EXPECT_EQ(a.record.T_keyframe_camera.matrix(), b.record.T_keyframe_camera.matrix());
  EXPECT_EQ(a.record.T_map_keyframe.matrix(), b.record.T_map_keyframe.matrix());
  EXPECT_EQ(a.record.known_since, b.record.known_since);
  EXPECT_EQ(a.record.previous_id, b.record.previous_id);
  EXPECT_EQ(a.record.T_map_previous.matrix(), b.record.T_map_previous.matrix());
  EXPECT_EQ(a.record.graph_version, b.record.graph_version);
  EXPECT_EQ(a.record.drift, b.record.drift);
  EXPECT_EQ(a.record.is_keyframe, b.record.is_keyframe);
  EXPECT_EQ(a.record.is_held, b.record.is_held);
  EXPECT_EQ(a.samples.camera(), b.samples.camera());
  EXPECT_EQ(a.samples.stride(), b.samples.stride());
  EXPECT_EQ(a.samples.depth_mm(), b.samples.depth_mm());
  EXPECT_EQ(a.samples.labels(), b.samples.labels());
}

class FrameJournalFile : public ::testing::Test {
 protected:
  std::string path() const { return (folder_.path() / "frames.lapis").string(); }
  static std::optional<std::string> append(FrameJournal& journal, const KeptFrame& frame) {
    return journal.append(frame.record, mapping::pack(frame.samples));
  }
  Bytes bytes() const {
    std::string error;
    const auto content = files::read_file(path(), error);
    EXPECT_TRUE(content) << error;
    return content.value_or(Bytes{});
  }
  void write(const Bytes& content) const {
    std::ofstream(path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
  }
  /// Appends these frames to a new file; returns where each of them ends.
  std::vector<std::size_t> write_frames(const std::vector<KeptFrame>& frames) const {
    FrameJournal journal(path(), kSession);
    std::vector<std::size_t> ends;
    for (const KeptFrame& frame : frames) {
      EXPECT_EQ(append(journal, frame), std::nullopt);
      ends.push_back(std::filesystem::file_size(path()));
    }
    return ends;
  }
  JournalSummary read() {
    read_.clear();
    std::string error;
    const auto keep = [this](const FrameRecord& record, mapping::CompactFrame samples) {
      read_.push_back({record, std::move(samples)});
      return true;
    };
    const auto journal = read_frame_journal(path(), keep, error);
    EXPECT_TRUE(journal) << error;
    return journal.value_or(JournalSummary{});
  }
  static std::string refusal(const std::string& file) {
    std::string error;
    const auto nobody = [](const FrameRecord&, const mapping::CompactFrame&) { return true; };
    EXPECT_FALSE(read_frame_journal(file, nobody, error));
    EXPECT_THAT(error, StartsWith(file + ": "));
    return error;
  }
  /// The first frames of the file are these, and no more; what follows them is `dropped`.
  void expect_frames(const std::vector<KeptFrame>& frames, std::size_t count, std::size_t dropped) {
    const JournalSummary journal = read();
    EXPECT_EQ(journal.session, kSession);
    EXPECT_EQ(journal.dropped, dropped);
    EXPECT_EQ(journal.end + journal.dropped, std::filesystem::file_size(path()));
    ASSERT_EQ(journal.frames, count);
    ASSERT_EQ(read_.size(), count);
    for (std::size_t i = 0; i < count; ++i) expect_same(read_[i], frames[i]);
  }

  std::mt19937 random_{1};
  std::vector<KeptFrame> read_;
  const lapis::test::TemporaryFolder folder_;
};

TEST_F(FrameJournalFile, GivesBackWhatWasAppended) {
  std::vector<KeptFrame> frames;
  for (int i = 0; i < 50; ++i) frames.push_back(tiny_frame(random_));
  write_frames(frames);
  expect_frames(frames, frames.size(), 0);
  EXPECT_TRUE(is_frame_journal(path()));
}

TEST_F(FrameJournalFile, BeginsWithItsFirstFrameAndReplacesWhatWasThere) {
  const std::vector<KeptFrame> frames{tiny_frame(random_), tiny_frame(random_), tiny_frame(random_)};
  write_frames({frames[0], frames[1]});
  FrameJournal journal(path(), kSession);
  expect_frames(frames, 2, 0);
  EXPECT_EQ(append(journal, frames[0]), std::nullopt);
  expect_frames(frames, 1, 0);
}

TEST_F(FrameJournalFile, AFrameTornAnywhereIsDroppedAndTheNextTakesItsPlace) {
  std::vector<KeptFrame> frames{tiny_frame(random_), tiny_frame(random_), tiny_frame(random_)};
  const std::vector<std::size_t> ends = write_frames(frames);
  const Bytes whole = bytes();
  frames[2] = tiny_frame(random_);
  for (std::size_t size = ends[1]; size < ends[2]; ++size) {
    write({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    expect_frames(frames, 2, size - ends[1]);
    FrameJournal journal(path(), kSession, ends[1]);
    ASSERT_EQ(append(journal, frames[2]), std::nullopt);
    ASSERT_NO_FATAL_FAILURE(expect_frames(frames, 3, 0)) << size;
  }
}

TEST_F(FrameJournalFile, ADamagedByteAnywhereLeavesTheFramesBeforeIt) {
  const std::vector<KeptFrame> frames{tiny_frame(random_), tiny_frame(random_), tiny_frame(random_)};
  const std::vector<std::size_t> ends = write_frames(frames);
  const Bytes whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes damaged = whole;
    damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 1u << random_() % 8);
    write(damaged);
    if (at < kHeaderSize) {
      refusal(path());
      continue;
    }
    const auto count = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), at) - ends.begin());
    const std::size_t end = count == 0 ? kHeaderSize : ends[count - 1];
    ASSERT_NO_FATAL_FAILURE(expect_frames(frames, count, whole.size() - end)) << at;
  }
}

TEST_F(FrameJournalFile, WhatIsNoJournalIsRefusedWithTheReason) {
  EXPECT_THAT(refusal(path()), HasSubstr("cannot be opened: No such file or directory"));
  EXPECT_THAT(refusal(folder_.path().string()), HasSubstr("cannot be opened: Is a directory"));
  EXPECT_FALSE(is_frame_journal(""));
  write({});
  EXPECT_THAT(refusal(path()), HasSubstr("is no journal of frames"));
  EXPECT_FALSE(is_frame_journal(path()));
  write_frames({tiny_frame(random_)});
  const Bytes whole = bytes();
  write({whole.begin(), whole.begin() + kHeaderSize - 1});
  EXPECT_THAT(refusal(path()), HasSubstr("is cut off"));
  Bytes other = whole;
  other[0] = 'M';
  write(other);
  EXPECT_THAT(refusal(path()), HasSubstr("is no journal of frames"));
  other = whole;
  other[8] = 2;
  write(other);
  EXPECT_THAT(refusal(path()), HasSubstr("has format version 2, this program reads 1"));
  other = whole;
  other[12] ^= 1u;
  write(other);
  EXPECT_THAT(refusal(path()), HasSubstr("is damaged: its header"));
}

/// A record whose checksum is right.
Bytes record_of(const Bytes& payload) {
  files::ByteWriter out;
  out.u32(static_cast<std::uint32_t>(payload.size()));
  out.u32(files::crc32(payload));
  out.raw(payload);
  return out.take();
}

void put_number(Bytes& payload, std::size_t at, double value) {
  files::ByteWriter out;
  out.f64(value);
  std::copy(out.bytes().begin(), out.bytes().end(), payload.begin() + static_cast<std::ptrdiff_t>(at));
}

TEST_F(FrameJournalFile, ImpossibleContentWithARightChecksumEndsIt) {
  const std::vector<KeptFrame> frames{tiny_frame(random_)};
  const std::vector<std::size_t> ends = write_frames(frames);
  const Bytes whole = bytes();
  const Bytes sound(whole.begin() + kHeaderSize + kRecordHeaderSize, whole.end());
  const auto expect_end_before = [&](const std::string& what, const Bytes& payload) {
    SCOPED_TRACE(what);
    Bytes file = whole;
    for (const Bytes& record : {record_of(payload), record_of(sound)})
      file.insert(file.end(), record.begin(), record.end());
    write(file);
    expect_frames(frames, 1, file.size() - ends[0]);
  };
  const auto with_number = [&](std::size_t at, double value) {
    Bytes payload = sound;
    put_number(payload, at, value);
    return payload;
  };
  const auto with_samples = [&](const Bytes& samples) {
    Bytes payload(sound.begin(), sound.begin() + kSamplesAt);
    payload.insert(payload.end(), samples.begin(), samples.end());
    return payload;
  };
  expect_end_before("negative stamp", with_number(kStampAt, -1.0));
  expect_end_before("stretched pose", with_number(kRotationAt, 2.0));
  expect_end_before("pose without a number", with_number(kPoseAt, std::nan("")));
  expect_end_before("previous pose without a number", with_number(kPreviousAt, std::nan("")));
  expect_end_before("negative drift", with_number(kDriftAt, -0.1));
  expect_end_before("endless drift", with_number(kDriftAt + 8, std::numeric_limits<double>::infinity()));
  Bytes flags = sound;
  flags[kFlagsAt] = 4;
  expect_end_before("unknown flag", flags);
  expect_end_before("nothing", {});
  expect_end_before("no samples", with_samples({}));
  expect_end_before("samples that are not packed", with_samples({1, 2, 3, 4, 5, 6, 7, 8, 9}));
  expect_end_before("samples of no frame", with_samples(files::zstd_compress(Bytes(100), 1)));
  // The first bytes of a zstd frame of 256 MB and one byte.
  const Bytes huge{0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0x01, 0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00};
  ASSERT_EQ(files::zstd_content_size(huge), (std::size_t{256} << 20) + 1);
  expect_end_before("samples that claim 256 MB and a byte", with_samples(huge));
}

TEST_F(FrameJournalFile, AFrameThatCannotBeKeptIsRefusedWithTheReason) {
  const KeptFrame frame = tiny_frame(random_);
  FrameJournal journal(path(), kSession);
  FrameRecord record = frame.record;
  record.stamp = {-1};
  EXPECT_EQ(journal.append(record, mapping::pack(frame.samples)),
            path() + ": takes no frame: its stamp is out of range");
  EXPECT_EQ(journal.append(frame.record, {}), path() + ": takes no frame: its samples are not packed");
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(FrameJournalFile, AFrameThatItsReaderRefusesEndsIt) {
  const std::vector<KeptFrame> frames{tiny_frame(random_), tiny_frame(random_), tiny_frame(random_)};
  const std::vector<std::size_t> ends = write_frames(frames);
  std::size_t visits = 0;
  std::string error;
  const auto first_only = [&](const FrameRecord&, const mapping::CompactFrame&) { return ++visits == 1; };
  const auto journal = read_frame_journal(path(), first_only, error);
  ASSERT_TRUE(journal) << error;
  EXPECT_EQ(visits, 2u);
  EXPECT_EQ(journal->frames, 1u);
  EXPECT_EQ(journal->end, ends[0]);
  EXPECT_EQ(journal->dropped, ends[2] - ends[0]);
}

TEST_F(FrameJournalFile, AFrameThatTheMapRefusesEndsIt) {
  const KeptFrame frame = tiny_frame(random_);
  FrameRecord far = frame.record;
  far.T_map_keyframe.translation().x() = 1e6;
  FrameJournal journal(path(), kSession);
  ASSERT_EQ(journal.append(far, mapping::pack(frame.samples)), std::nullopt);
  SemanticMapper mapper(MapperConfig{});
  std::string error;
  const auto summary = read_frame_journal(
      path(), [&](const auto& record, auto samples) { return mapper.restore(record, std::move(samples)); }, error);
  ASSERT_TRUE(summary) << error;
  EXPECT_EQ(summary->frames, 0u);
  EXPECT_EQ(mapper.frames_integrated(), 0u);
}

TEST_F(FrameJournalFile, ADiskThatIsFullCostsOnlyTheFramesThatItDoesNotTake) {
  const std::vector<KeptFrame> frames{tiny_frame(random_), tiny_frame(random_), tiny_frame(random_)};
  FrameJournal journal(path(), kSession);
  ASSERT_EQ(append(journal, frames[0]), std::nullopt);
  const std::size_t size = bytes().size();
  {
    const lapis::test::FullDisk disk(size + 100);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(append(journal, frames[1]), path() + ": cannot be written: File too large");
      EXPECT_EQ(bytes().size(), size) << "nothing of it stays";
    }
  }
  EXPECT_EQ(append(journal, frames[1]), std::nullopt);
  EXPECT_EQ(append(journal, frames[2]), std::nullopt);
  expect_frames(frames, 3, 0);
}

TEST_F(FrameJournalFile, ThatCannotBeBegunIsBegunWithALaterFrame) {
  const std::string late = (folder_.path() / "later" / "frames.lapis").string();
  FrameJournal journal(late, kSession);
  const KeptFrame frame = tiny_frame(random_);
  EXPECT_EQ(append(journal, frame), late + ": cannot be created: No such file or directory");
  std::filesystem::create_directory(folder_.path() / "later");
  EXPECT_EQ(append(journal, frame), std::nullopt);
  EXPECT_TRUE(is_frame_journal(late));
}

/// What a mapper gets in the course of a run: a frame, or a version of the pose graph.
struct Input {
  std::optional<AnchoredFrame> frame;
  std::uint64_t graph_version = 0;
  std::vector<KeyframePose> graph = {};
};

/// A pool of views of the room; a frame need not show what is at its pose.
const mapping::CompactFrame& any_view(std::mt19937& random) {
  static const std::vector<mapping::CompactFrame> kViews = [] {
    const geometry::PinholeCamera camera{80, 45, 40, 40, 39.5, 22.0};
    std::vector<mapping::CompactFrame> views;
    for (int i = 0; i < 8; ++i) {
      const auto image = lapis::test::render(lapis::test::furnished_room(), camera,
                                             lapis::test::look({0.3 * i - 1.0, 0.2, 1.0}, 0.8 * i, 0.1));
      std::string error;
      views.push_back(mapping::CompactFrame::make(camera, image.depth, &image.labels, {1, 40}, error).value());
    }
    return views;
  }();
  return kViews[random() % kViews.size()];
}

/// Plays slam: its key-frames, some of which drift until a correction; not every version of its graph is published.
class RandomRun {
 public:
  explicit RandomRun(unsigned seed) : random_(seed) {
    for (int i = 0; i < 40; ++i) {
      if (i % 5 == 0) add_keyframe();
      if (i > 0 && one_in(3)) correct();
      if (one_in(3)) publish_graph();
      inputs_.push_back({random_frame(i)});
    }
    correct();
    publish_graph();
  }
  const std::vector<Input>& inputs() const { return inputs_; }

 private:
  bool one_in(unsigned n) { return random_() % n == 0; }
  void add_keyframe() {
    const auto id = static_cast<std::uint64_t>(keyframes_.size());
    const Pose T_map_keyframe = lapis::test::look({0.3 * static_cast<double>(id), 0.1, 1.0}, 0.5, 0.1);
    keyframes_.push_back({id, T_map_keyframe, id > 0 && one_in(2)});
    is_first_of_keyframe_ = true;
  }
  void correct() {
    ++version_;
    for (KeyframePose& keyframe : keyframes_) {
      if (one_in(2)) keyframe.T_map_keyframe = random_pose(random_, 0.1) * keyframe.T_map_keyframe;
      if (one_in(4)) keyframe.is_drifting = false;
    }
  }
  void publish_graph() { inputs_.push_back({std::nullopt, version_, keyframes_}); }
  AnchoredFrame random_frame(int i) {
    const KeyframePose& keyframe = one_in(4) ? keyframes_[random_() % keyframes_.size()] : keyframes_.back();
    const bool is_keyframe = std::exchange(is_first_of_keyframe_, false) && &keyframe == &keyframes_.back();
    const bool drifts = keyframe.is_drifting || (!is_keyframe && one_in(3));
    const mapping::Drift drift{drifts ? 0.02 * static_cast<double>(1 + random_() % 6) : 0.0, drifts ? 0.01 : 0.0};
    return {time::Time{i},
            keyframe.id,
            keyframe.T_map_keyframe,
            is_keyframe ? Pose::Identity() : random_pose(random_, 0.1),
            version_,
            any_view(random_),
            drift,
            is_keyframe};
  }

  std::mt19937 random_;
  std::vector<KeyframePose> keyframes_;
  std::uint64_t version_ = 1;
  bool is_first_of_keyframe_ = false;
  std::vector<Input> inputs_;
};

/// A mapper that keeps its frames, and is killed again and again.
class KilledMapper {
 public:
  KilledMapper(const MapperConfig& config, const std::string& path)
      : config_(config), path_(path), mapper_(std::make_unique<SemanticMapper>(config)),
        journal_(std::make_unique<FrameJournal>(path, kSession)) {}

  void take(const Input& input) {
    if (input.frame) {
      ASSERT_EQ(mapper_->integrate(*input.frame).status, IntegrationStatus::kIntegrated);
      const auto packed = mapper_->store().packed_frame(mapper_->store().size() - 1);
      ASSERT_TRUE(packed);
      ASSERT_EQ(journal_->append(*mapper_->newest_record(), *packed), std::nullopt);
    } else {
      graph_ = &input;
      follow_graph();
    }
  }
  /// Leaves a torn frame behind, begins anew with the journal, and gets the graph that slam keeps latched.
  void kill(std::mt19937& random) {
    const std::size_t frames = mapper_->frames_integrated();
    if (frames == 0) return;
    std::ofstream(path_, std::ios::binary | std::ios::app) << std::string(random() % 300, 'x');
    std::string error;
    mapper_ = std::make_unique<SemanticMapper>(config_);
    const auto journal = read_frame_journal(
        path_, [this](const auto& record, auto samples) { return mapper_->restore(record, std::move(samples)); },
        error);
    ASSERT_TRUE(journal) << error;
    ASSERT_EQ(journal->frames, frames);
    journal_ = std::make_unique<FrameJournal>(path_, kSession, journal->end);
    follow_graph();
  }
  SemanticMapper& mapper() { return *mapper_; }

 private:
  void follow_graph() {
    if (graph_ != nullptr) mapper_->update_keyframe_poses(graph_->graph_version, graph_->graph);
  }

  MapperConfig config_;
  std::string path_;
  std::unique_ptr<SemanticMapper> mapper_;
  std::unique_ptr<FrameJournal> journal_;
  const Input* graph_ = nullptr;  ///< newest one
};

TEST_F(FrameJournalFile, GivesTheMapOfAMapperThatWasNeverKilled) {
  std::size_t in_part = 0, waiting = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    MapperConfig config;
    config.resolution_m = seed % 4 == 3 ? 0.1 : 0.25;
    config.stored_frames = {seed % 3 == 0 ? 0 : 100, testing::TempDir()};
    SemanticMapper whole(config);
    KilledMapper killed(config, path());
    const RandomRun run(seed);
    for (const Input& input : run.inputs()) {
      if (random_() % 8 == 0) {
        ASSERT_NO_FATAL_FAILURE(killed.kill(random_));
      }
      ASSERT_NO_FATAL_FAILURE(killed.take(input));
      if (input.frame) whole.integrate(*input.frame);
      if (!input.frame) whole.update_keyframe_poses(input.graph_version, input.graph);
      for (SemanticMapper* mapper : {&whole, &killed.mapper()}) mapper->re_anchor(random_() % 100'000);
    }
    for (SemanticMapper* mapper : {&whole, &killed.mapper()}) mapper->flush();
    ASSERT_EQ(killed.mapper().map(), whole.map());
    EXPECT_EQ(killed.mapper().frames_integrated(), whole.frames_integrated());
    EXPECT_EQ(killed.mapper().graph_version(), whole.graph_version());
    EXPECT_EQ(killed.mapper().frames_waiting(), whole.frames_waiting());
    EXPECT_EQ(killed.mapper().frames_in_part(), whole.frames_in_part());
    in_part += whole.frames_in_part();
    waiting += whole.frames_waiting();
  }
  EXPECT_GT(in_part, 0u);
  EXPECT_GT(waiting, 0u);
}

}  // namespace
}  // namespace lapis::semantic_mapper
