#include "common/mapping/file/map_file.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include <sys/resource.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <zstd.h>

#include "common/files/atomic_file.hpp"
#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"
#include "tests/unit/mapping/random_votes.hpp"

namespace lapis::mapping {
namespace {

namespace fs = std::filesystem;

class MapFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapis_map_file_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

MapFile example(unsigned seed = 1, int frames = 20) {
  MapFile file{test::random_map(seed, 0.1, frames), {}, LabelList::from_names({{1, "wall"}, {7, "chair"}}), {}};
  file.sensor_model.prior_occupied = 0.3;
  file.sensor_model.fusion = "dirichlet";
  file.sensor_model.prior_votes = 7.0;
  file.provenance = {{"source", "test"}, {"frames", "20"}};
  file.frames = FrameSettings{{0.3, 4.0, -2.0, 3.0, 1.0, 0.002, 2.5}, 3};
  return file;
}

void expect_equal(const MapFile& a, const MapFile& b) {
  EXPECT_EQ(a.map, b.map);
  EXPECT_EQ(a.sensor_model, b.sensor_model);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.provenance, b.provenance);
  EXPECT_EQ(a.frames, b.frames);
}

TEST_F(MapFileTest, LoadedEqualsSaved) {
  const MapFile file = example();
  ASSERT_EQ(save_map(path("map.lapis"), file), std::nullopt);
  std::string error;
  const auto loaded = load_map(path("map.lapis"), error);
  ASSERT_TRUE(loaded) << error;
  expect_equal(*loaded, file);
  EXPECT_FALSE(fs::exists(path("map.lapis.part")));
}

TEST_F(MapFileTest, ModelWithPriorsAndEmptyMapSurvive) {
  MapFile file{VoxelMap(0.02), paper_sensor_model(), {}, {}};
  std::string error;
  const auto loaded = decode_map(encode_map(file), error);
  ASSERT_TRUE(loaded) << error;
  expect_equal(*loaded, file);
}

TEST_F(MapFileTest, EqualMapsGiveEqualBytes) {
  std::mt19937 random(3);
  std::vector<FrameVotes> all;
  for (int i = 0; i < 20; ++i) all.push_back(test::random_votes(random));
  MapFile a{VoxelMap(0.1), {}, {}, {}}, b = a;
  for (const FrameVotes& votes : all) a.map.add(votes);
  std::for_each(all.rbegin(), all.rend(), [&b](const FrameVotes& votes) { b.map.add(votes); });
  EXPECT_EQ(encode_map(a), encode_map(b));
}

TEST_F(MapFileTest, EveryFlippedBitAndEveryTruncationIsRefused) {
  const std::vector<std::uint8_t> good = encode_map(example(1, 1));
  std::string error;
  ASSERT_TRUE(decode_map(good, error));
  for (std::size_t size = 0; size < good.size(); ++size) ASSERT_FALSE(decode_map(std::span(good).first(size), error));
  std::vector<std::uint8_t> bad = good;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1u << bit % 8));
    ASSERT_FALSE(decode_map(bad, error)) << "bit " << bit;
    ASSERT_FALSE(error.empty());
    bad[bit / 8] = good[bit / 8];
  }
  bad.push_back(0);
  EXPECT_FALSE(decode_map(bad, error));
}

/// A file around a payload of any kind, with the right sums.
std::vector<std::uint8_t> file_of(std::span<const std::uint8_t> payload, std::uint8_t format_version = 3) {
  std::vector<std::uint8_t> good = encode_map(example(1, 1));
  good[8] = format_version;
  files::ByteWriter checked, file;
  checked.u64(payload.size());
  checked.raw(payload);
  file.raw(std::span(good).first(12));
  file.u32(files::crc32(checked.bytes()));
  file.raw(checked.bytes());
  return file.take();
}

TEST_F(MapFileTest, AFileOfTheFormerVersionSaysNothingOfFrames) {
  MapFile file{VoxelMap(0.1), {}, LabelList::from_names({{1, "wall"}}), {{"source", "before"}}};
  const std::vector<std::uint8_t> good = encode_map(file);
  std::vector<std::uint8_t> content = *files::zstd_decompress(std::span(good).subspan(24), 1 << 20);
  content.erase(content.end() - 2);  // whether the settings of frames are known; the last byte: no blocks
  std::string error;
  const auto loaded = decode_map(file_of(files::zstd_compress(content, 1), 2), error);
  ASSERT_TRUE(loaded) << error;
  expect_equal(*loaded, file);
}

TEST_F(MapFileTest, SettingsOfFramesOutOfRangeAreRefused) {
  MapFile file = example(1, 1);
  file.frames->integration.max_range_m = -1.0;
  std::string error;
  EXPECT_FALSE(decode_map(encode_map(file), error));
  EXPECT_NE(error.find("max_range_m"), std::string::npos) << error;
}

/// A zstd frame of `begin` and then zeros, `size` bytes in all, that says so.
std::vector<std::uint8_t> zeros_after(const std::vector<std::uint8_t>& begin, std::size_t size) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  ZSTD_CCtx_setPledgedSrcSize(context.get(), size);
  std::vector<std::uint8_t> frame(1 << 20);
  ZSTD_outBuffer out{frame.data(), frame.size(), 0};
  std::vector<std::uint8_t> piece = begin;
  for (std::size_t left = size; left > 0;) {
    piece.resize(std::min(left, std::size_t{1} << 20));
    ZSTD_inBuffer in{piece.data(), piece.size(), 0};
    left -= piece.size();
    EXPECT_FALSE(ZSTD_isError(ZSTD_compressStream2(context.get(), &out, &in, left > 0 ? ZSTD_e_continue : ZSTD_e_end)));
    EXPECT_EQ(in.pos, in.size);
    piece.assign(piece.size(), 0);
  }
  frame.resize(out.pos);
  return frame;
}

TEST_F(MapFileTest, MaliciousContentWithGoodChecksumNeverCrashes) {
  // Damages the content below zstd and checksum, as a writer with a bug would.
  const std::vector<std::uint8_t> good = encode_map(example(2, 2));
  const auto content = files::zstd_decompress(std::span(good).subspan(24), 1 << 24);
  ASSERT_TRUE(content);
  std::mt19937 random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<std::uint8_t> bad = *content;
    for (int i = 0; i < 1 + trial % 4; ++i)
      bad[random() % (trial % 2 ? bad.size() : 150)] = static_cast<std::uint8_t>(random());
    if (trial % 5 == 0) bad.resize(random() % bad.size());
    std::string error;
    const bool is_loaded = decode_map(file_of(files::zstd_compress(bad, 1)), error).has_value();
    EXPECT_NE(is_loaded, !error.empty());
  }
}

/// Peak of this process's memory so far [MB].
long peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss >> 10;
}

TEST_F(MapFileTest, AFewBytesThatClaimGigabytesTakeNoMemory) {
  constexpr std::size_t kClaimed = std::size_t{2} << 30;
  const std::vector<std::uint8_t> good = encode_map(example(1, 0));
  std::vector<std::uint8_t> content = *files::zstd_decompress(std::span(good).subspan(24), 1 << 24);
  content.back() = 0xff;  // the number of blocks: very many, all of zeros
  content.insert(content.end(), {0xff, 0xff, 0xff, 0x7f});
  const std::vector<std::uint8_t> bomb = file_of(zeros_after(content, kClaimed));
  EXPECT_LT(bomb.size(), std::size_t{1} << 20);
  const long before = peak_rss_mb();
  std::string error;
  EXPECT_FALSE(decode_map(bomb, error));
  EXPECT_EQ(error, "is damaged: the content is malformed");
  EXPECT_LT(peak_rss_mb(), before + 500);
}

TEST_F(MapFileTest, AMapBeyondTheMemoryForMapsIsRefused) {
  MapFile file{VoxelMap(0.1), {}, {}, {}};
  VoxelBlock block(kOneVote);
  block.add_miss(0, kOneVote);  // half a kilobyte in memory, nearly nothing in a file
  for (std::int32_t x = 0; x < 10'000; ++x) file.map.set_block({x, 0, 0}, block);
  const std::vector<std::uint8_t> bytes = encode_map(file);
  EXPECT_LT(bytes.size(), 100'000u);
  std::string error;
  EXPECT_FALSE(decode_map(bytes, error, 1 << 20));
  EXPECT_EQ(error, "has a value out of range: a map of more than 1 MB of memory");
  const auto loaded = decode_map(bytes, error, file.map.bytes());
  ASSERT_TRUE(loaded) << error;
  EXPECT_EQ(loaded->map, file.map);
}

TEST_F(MapFileTest, HundredMillionVoxelsAreSavedAndLoaded) {
  MapFile file{VoxelMap(0.05), {}, {}, {}};
  VoxelBlock seen(20 * kOneVote), torn(20 * kOneVote);
  torn.add_miss(7, kOneVote);
  constexpr std::int32_t kEdge = 58;  // blocks
  for (std::int32_t i = 0; i < kEdge * kEdge * kEdge; ++i)
    file.map.set_block({i % kEdge, i / kEdge % kEdge, i / kEdge / kEdge}, i % 8 == 0 ? torn : seen);
  ASSERT_EQ(save_map(path("map.lapis"), file), std::nullopt);
  const auto begin = std::chrono::steady_clock::now();
  std::string error;
  const auto loaded = load_map(path("map.lapis"), error);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  ASSERT_TRUE(loaded) << error;
  EXPECT_EQ(loaded->map, file.map);
  std::cout << "figure: file " << fs::file_size(path("map.lapis")) << " bytes, memory " << loaded->map.bytes()
            << " bytes, loaded in " << taken.count() << " s\n";
  EXPECT_LT(loaded->map.bytes(), 40'000'000u);
}

TEST_F(MapFileTest, ABlockThatIsLargerThanUsualIsRead) {
  MapFile file{VoxelMap(0.1), {}, {}, {}};
  VoxelBlock block;
  for (int offset = 0; offset < kBlockVoxels; ++offset)
    for (std::uint16_t label = 1; label <= 100; ++label) block.add_hit(offset, label, 1'000'000'007u * label);
  file.map.set_block({1, 2, 3}, block);
  file.map.set_block({2, 2, 3}, block);
  std::string error;
  const auto loaded = decode_map(encode_map(file), error);
  ASSERT_TRUE(loaded) << error;
  EXPECT_EQ(loaded->map, file.map);
}

TEST_F(MapFileTest, ErrorsNameFileAndReason) {
  std::string error;
  EXPECT_FALSE(load_map(path("absent.lapis"), error));
  EXPECT_NE(error.find("absent.lapis"), std::string::npos);
  std::ofstream(path("text.lapis")) << "this is not a map, but long enough to be one";
  EXPECT_FALSE(load_map(path("text.lapis"), error));
  EXPECT_NE(error.find("text.lapis: is not a Lapis map"), std::string::npos) << error;
  EXPECT_FALSE(load_map(folder_.string(), error));
  const auto failure = save_map(path("no_such_folder/map.lapis"), example());
  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find("no_such_folder/map.lapis"), std::string::npos);
}

TEST_F(MapFileTest, NewerFormatVersionIsNamed) {
  std::vector<std::uint8_t> bytes = encode_map(example());
  bytes[8] = 9;
  std::string error;
  EXPECT_FALSE(decode_map(bytes, error));
  EXPECT_NE(error.find("format version 9"), std::string::npos);
}

TEST_F(MapFileTest, OldFileStaysWholeWhenThereIsNoSpace) {
  const std::string file = path("map.lapis");
  const MapFile old = example(1, 1);
  ASSERT_EQ(save_map(file, old), std::nullopt);
  // A file size limit makes write() fail as a full disk does.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1024, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto failure = save_map(file, example(2, 50));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  ASSERT_TRUE(failure);
  EXPECT_NE(failure->find(file), std::string::npos);
  EXPECT_FALSE(fs::exists(file + ".part"));
  std::string error;
  const auto loaded = load_map(file, error);
  ASSERT_TRUE(loaded) << error;
  expect_equal(*loaded, old);
}

TEST(Crc32, GivesTheStandardCheckValue) {
  const std::string text = "123456789";
  EXPECT_EQ(files::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), 0xCBF43926u);
}

}  // namespace
}  // namespace lapis::mapping
