#include "common/dds/shared_memory.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace lapis::dds {
namespace {

using ::testing::HasSubstr;

class SharedMemoryFolder : public ::testing::Test {
 protected:
  void TearDown() override {
    for (const int file : open_) ::close(file);
  }
  void make(const std::string& name, int bytes = 0) {
    std::ofstream(folder.path() / name) << std::string(static_cast<std::size_t>(bytes), 'x');
  }
  int open(const std::string& name) {
    open_.push_back(::open((folder.path() / name).c_str(), O_RDWR));
    return open_.back();
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder.path() / name); }

  test::TemporaryFolder folder;
  SharedMemory memory{folder.path()};

 private:
  std::vector<int> open_;
};

TEST_F(SharedMemoryFolder, WhatDeadProcessesLeftIsRemovedAndNothingElse) {
  make("fastrtps_00000000deadbeef", 1000);
  make("fastrtps_00000000deadbeef_el");
  make("fastrtps_00000000a11fe000", 1000);
  make("fastrtps_00000000a11fe000_el");
  ASSERT_EQ(::flock(open("fastrtps_00000000a11fe000_el"), LOCK_EX), 0);
  make("fastrtps_port7411", 50);
  make("fastrtps_port7411_el");
  make("sem.fastrtps_port7411_mutex", 32);
  make("fastrtps_port7412", 50);  // nobody has read it yet, so it has no lock
  make("something_el", 1);
  const auto reaped = memory.reap();
  EXPECT_EQ(reaped.files, 5);
  EXPECT_EQ(reaped.bytes, 1082U);
  for (const auto* gone : {"fastrtps_00000000deadbeef", "fastrtps_00000000deadbeef_el", "fastrtps_port7411",
                           "fastrtps_port7411_el", "sem.fastrtps_port7411_mutex"}) {
    EXPECT_FALSE(exists(gone)) << gone;
  }
  for (const auto* kept :
       {"fastrtps_00000000a11fe000", "fastrtps_00000000a11fe000_el", "fastrtps_port7412", "something_el"}) {
    EXPECT_TRUE(exists(kept)) << kept;
  }
  EXPECT_EQ(memory.reap().files, 0);
}

TEST_F(SharedMemoryFolder, PortThatAnotherProcessWritesToStays) {
  make("fastrtps_port7411", 50);
  make("fastrtps_port7411_el");
  void* mapping = ::mmap(nullptr, 50, PROT_READ, MAP_SHARED, open("fastrtps_port7411"), 0);
  ASSERT_NE(mapping, MAP_FAILED);
  EXPECT_EQ(memory.reap().files, 0);
  ::munmap(mapping, 50);
  EXPECT_EQ(memory.reap().files, 2);
}

TEST_F(SharedMemoryFolder, WithoutRoomIsAnObstacleWithTheFigures) {
  EXPECT_EQ(memory.obstacle(1000), "");
  EXPECT_THAT(memory.obstacle(std::uint64_t{1} << 60), HasSubstr("MB left, and a participant needs 1099511627777 MB"));
  EXPECT_THAT(SharedMemory(folder.path() / "missing").obstacle(1000), HasSubstr("missing cannot be used: "));
  EXPECT_EQ(SharedMemory(folder.path() / "missing").reap().files, 0);
}

TEST_F(SharedMemoryFolder, ParticipantsAreCreatedInTurn) {
  {
    const SharedMemory::Turn turn(memory);
    const int other = open("lapis_turn");
    EXPECT_NE(::flock(other, LOCK_EX | LOCK_NB), 0);
  }
  EXPECT_EQ(::flock(open("lapis_turn"), LOCK_EX | LOCK_NB), 0);
  const SharedMemory::Turn nowhere(SharedMemory(folder.path() / "missing"));
}

}  // namespace
}  // namespace lapis::dds
