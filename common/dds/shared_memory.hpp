#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace lapis::dds {

/// What Fast DDS keeps in a folder of shared memory (fastrtps_*): a segment per participant, a port per receiver, and
/// beside each of them a lock file (_el) that its process holds until it ends, however it ends.
class SharedMemory {
 public:
  /// @param folder other folders are for tests
  explicit SharedMemory(std::filesystem::path folder = "/dev/shm") : folder_(std::move(folder)) {}

  /// While it is held, no other process holds one: each finds the room that is left, and reaps no segment of which the
  /// lock is about to be taken.
  class Turn {
   public:
    /// Waits for the others, but no longer than `patience`; then it is not held. Nor is it where its file cannot be
    /// opened.
    explicit Turn(const SharedMemory& memory, std::chrono::milliseconds patience = std::chrono::seconds(10));
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    bool is_held() const { return is_held_; }

   private:
    int file_ = -1;
    bool is_held_ = false;
  };

  struct Reaped {
    int files = 0;
    std::uint64_t bytes = 0;
  };
  /// Removes the segments that processes of this user left behind, which nobody else does; nothing if the turn is not
  /// held. That nobody has the lock says that the process has ended, even one in another container. Ports stay: they
  /// are small (52 kB) and used again, and who still writes to one cannot be seen from another container.
  Reaped reap(const Turn& turn) const;

  /// Why a participant cannot have a segment here, for people; empty when it can. A process that touches a page which
  /// the folder has no room for is ended by SIGBUS, so the room is looked for first.
  std::string obstacle(std::uint64_t segment_bytes) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lapis::dds
