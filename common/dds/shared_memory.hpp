#pragma once

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

  struct Reaped {
    int files = 0;
    std::uint64_t bytes = 0;
  };
  /// Removes what processes that have ended left behind, which nobody else does. Leaves what other users own, and ports
  /// that a process of this user still has open.
  Reaped reap() const;

  /// Why a participant cannot have a segment here, for people; empty when it can. A process that touches a page which
  /// the folder has no room for is ended by SIGBUS, so the room is looked for first.
  std::string obstacle(std::uint64_t segment_bytes) const;

  /// While it lives, no other process that holds one creates a participant here: each finds the room that is left.
  class Turn {
   public:
    explicit Turn(const SharedMemory& memory);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    int file_ = -1;
  };

 private:
  std::filesystem::path folder_;
};

}  // namespace lapis::dds
