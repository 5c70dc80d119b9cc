#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/bags/bag.hpp"
#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// What a topic of a bag is in a frame.
enum class Role {
  kColor,  ///< one message makes a frame
  kPart,   ///< belongs to the frame with the nearest stamp: depth, intrinsics, labels
  kOther,  ///< belongs to the first frame with a stamp that is not before its own: odometry
};

/// Puts the messages of a bag together as a camera would publish them: for each colour image all that belongs to it, by
/// header stamps. The order in which topics were recorded does not matter, as long as it is within kLookahead_s.
class BagFrames {
 public:
  /// How much later than a colour image what belongs to it may have been recorded [s].
  static constexpr double kLookahead_s = 1.0;

  /// @param reader gives the selected messages; it has to outlive this
  /// @param roles of its channels; nothing: a channel whose messages are left out
  BagFrames(bags::StorageReader& reader, std::vector<std::optional<Role>> roles);

  struct Frame {
    time::Time stamp;                     ///< of the colour image
    std::vector<bags::Message> messages;  ///< in the order of their stamps, the colour image last
  };
  /// The next frame; nothing at the end. What is left after the last colour image is left out.
  std::optional<Frame> next();
  /// Messages that were left out because they have no readable stamp.
  std::uint64_t unreadable() const { return unreadable_; }

 private:
  struct Stamped {
    time::Time stamp;
    bags::Message message;
  };
  bool read_more();
  /// The n-th colour image that waits.
  const Stamped* color(std::size_t n) const;
  bool is_complete(const Stamped& color) const;
  bool has_seen_all_of(std::size_t channel, const Stamped& color) const;
  time::Time end_of(const Stamped& color, Role role) const;

  bags::StorageReader& reader_;
  std::vector<std::optional<Role>> roles_;
  std::deque<Stamped> waiting_;                    // in the order of the bag
  std::vector<std::optional<time::Time>> newest_;  // stamp on each channel
  std::int64_t read_ns_ = 0;                       // log time of the newest message
  bool is_at_end_ = false;
  std::uint64_t unreadable_ = 0;
};

}  // namespace lapis::sensor_replay
