#include "common/dds/shared_memory.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
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

TEST_F(SharedMemoryFolder, SegmentsOfDeadProcessesAreRemovedAndNothingElse) {
  make("fastrtps_00000000deadbeef", 1000);
  make("fastrtps_00000000deadbeef_el");
  make("fastrtps_00000000a11fe000", 1000);
  make("fastrtps_00000000a11fe000_el");
  ASSERT_EQ(::flock(open("fastrtps_00000000a11fe000_el"), LOCK_EX), 0);
  make("something_el", 1);
  const SharedMemory::Turn turn(memory);
  const auto reaped = memory.reap(turn);
  EXPECT_EQ(reaped.files, 2);
  EXPECT_EQ(reaped.bytes, 1000U);
  for (const auto* gone : {"fastrtps_00000000deadbeef", "fastrtps_00000000deadbeef_el"}) EXPECT_FALSE(exists(gone));
  for (const auto* kept : {"fastrtps_00000000a11fe000", "fastrtps_00000000a11fe000_el", "something_el"}) {
    EXPECT_TRUE(exists(kept)) << kept;
  }
  EXPECT_EQ(memory.reap(turn).files, 0);
}

/// A process that writes to a port cannot be seen from another container that has the same /dev/shm.
TEST_F(SharedMemoryFolder, PortsStay) {
  make("fastrtps_port7411", 50);
  make("fastrtps_port7411_el");
  make("sem.fastrtps_port7411_mutex", 32);
  EXPECT_EQ(memory.reap(SharedMemory::Turn(memory)).files, 0);
}

TEST_F(SharedMemoryFolder, WithoutRoomIsAnObstacleWithTheFigures) {
  EXPECT_EQ(memory.obstacle(1000), "");
  EXPECT_THAT(memory.obstacle(std::uint64_t{1} << 60), HasSubstr("MB left, and a participant needs 1099511627777 MB"));
  EXPECT_THAT(SharedMemory(folder.path() / "missing").obstacle(1000), HasSubstr("missing cannot be used: "));
  const SharedMemory missing(folder.path() / "missing");
  EXPECT_EQ(missing.reap(SharedMemory::Turn(missing)).files, 0);
}

TEST_F(SharedMemoryFolder, ParticipantsAreCreatedInTurn) {
  {
    const SharedMemory::Turn turn(memory);
    EXPECT_TRUE(turn.is_held());
    const int other = open("lapis_turn");
    EXPECT_NE(::flock(other, LOCK_EX | LOCK_NB), 0);
  }
  EXPECT_EQ(::flock(open("lapis_turn"), LOCK_EX | LOCK_NB), 0);
}

TEST_F(SharedMemoryFolder, ATurnThatDoesNotComeIsNotWaitedForWithoutEndAndNothingIsReaped) {
  make("fastrtps_00000000deadbeef", 1000);
  make("fastrtps_00000000deadbeef_el");
  const SharedMemory::Turn of_another(memory);
  const SharedMemory::Turn turn(memory, std::chrono::milliseconds(20));
  EXPECT_FALSE(turn.is_held());
  EXPECT_EQ(memory.reap(turn).files, 0);
  EXPECT_FALSE(SharedMemory::Turn(SharedMemory(folder.path() / "missing")).is_held());
}

/// Linux refuses to open such a file with O_CREAT (fs.protected_regular), to root, too.
TEST_F(SharedMemoryFolder, ATurnFileOfAnotherUserIsUsed) {
  constexpr uid_t kNobody = 65534;
  make("lapis_turn");
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all | std::filesystem::perms::sticky_bit);
  if (::chown((folder.path() / "lapis_turn").c_str(), kNobody, kNobody) != 0) GTEST_SKIP() << "only root can chown";
  EXPECT_TRUE(SharedMemory::Turn(memory).is_held());
}

}  // namespace
}  // namespace lapis::dds
