#include "sensor_replay/core/frame_prefetcher.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "sensor_replay/camera_yaml.hpp"
#include "synthetic_dataset.hpp"

namespace lapis::sensor_replay {
namespace {

LoadedFrame skipped(std::size_t index) { return SkippedFrame{index, {}, {}}; }

TEST(FramePrefetcher, DeliversTheRangeInOrderAndThenNothing) {
  for (const std::size_t capacity : {0u, 1u, 4u, 100u}) {
    FramePrefetcher frames(skipped, {3, 40}, capacity);
    for (std::size_t i = 3; i < 40; ++i) {
      const auto frame = frames.next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(std::get<SkippedFrame>(*frame).index, i);
    }
    EXPECT_FALSE(frames.next());
    EXPECT_FALSE(frames.next());
  }
}

TEST(FramePrefetcher, GivesTheSameBytesAsLoadingOneByOne) {
  const test::TemporaryFolder folder;
  test::write_dataset(folder.path(), 12);
  test::truncate(folder.path() / "depth/00003.png", 0.5);
  std::filesystem::remove(folder.path() / "rgb/00005.png");
  const TumDataset dataset({.folder = folder.path(), .class_list = {}}, read_camera_file);
  FramePrefetcher frames([&](std::size_t index) { return dataset.load_frame(index); }, {0, dataset.size()});
  for (std::size_t i = 0; i < dataset.size(); ++i) {
    const LoadedFrame expected = dataset.load_frame(i);
    const LoadedFrame actual = frames.next().value();
    ASSERT_EQ(actual.index(), expected.index()) << i;
    if (const auto* frame = std::get_if<ReplayFrame>(&expected)) {
      EXPECT_EQ(std::get<ReplayFrame>(actual).color.pixels, frame->color.pixels);
      EXPECT_EQ(std::get<ReplayFrame>(actual).depth.has_value(), frame->depth.has_value());
      EXPECT_EQ(std::get<ReplayFrame>(actual).problems.size(), frame->problems.size());
    }
  }
  EXPECT_FALSE(frames.next());
}

TEST(FramePrefetcher, NeverLoadsFurtherAheadThanItsCapacity) {
  constexpr std::size_t kCapacity = 3;
  std::atomic<std::size_t> loads = 0;
  FramePrefetcher frames(
      [&](std::size_t index) {
        ++loads;
        return skipped(index);
      },
      {0, 500}, kCapacity);
  for (std::size_t taken = 0; taken < 500; ++taken) {
    EXPECT_LE(loads.load(), taken + kCapacity);
    ASSERT_TRUE(frames.next());
  }
}

TEST(FramePrefetcher, StopsWithoutLoadingTheRest) {
  constexpr std::size_t kCapacity = 2;
  std::atomic<std::size_t> loads = 0;
  const auto load = [&](std::size_t index) {
    ++loads;
    return skipped(index);
  };
  for (std::size_t taken = 0; taken < 20; ++taken) {
    loads = 0;
    {
      FramePrefetcher frames(load, {0, 1'000'000}, kCapacity);
      for (std::size_t i = 0; i < taken; ++i) ASSERT_TRUE(frames.next());
    }
    EXPECT_LE(loads.load(), taken + kCapacity);
  }
}

TEST(FramePrefetcher, EmptyRangeEndsAtOnce) {
  FramePrefetcher frames(skipped, {7, 7});
  EXPECT_FALSE(frames.next());
}

TEST(FramePrefetcher, ALoaderThatThrowsIsHeardInItsPlace) {
  FramePrefetcher frames(
      [](std::size_t index) {
        if (index == 2) throw std::runtime_error("broken loader");
        return skipped(index);
      },
      {0, 5});
  EXPECT_TRUE(frames.next());
  EXPECT_TRUE(frames.next());
  EXPECT_THROW(frames.next(), std::runtime_error);
  EXPECT_FALSE(frames.next());
}

}  // namespace
}  // namespace lapis::sensor_replay
