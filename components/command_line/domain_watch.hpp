#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "command_line/core/rate_meter.hpp"
#include "command_line/core/snapshot.hpp"
#include "command_line/domain.hpp"
#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"
#include "common/dds/raw.hpp"

namespace lapis::command_line {

/// Watches what a run of Lapis needs: the topics of the camera and the robot, and all endpoints.
class DomainWatch {
 public:
  explicit DomainWatch(Domain& domain);

  /// Watches for a while, from the moment on at which discovery finds nothing more.
  void watch(Seconds duration);
  Snapshot snapshot() const;

 private:
  /// A topic that is read.
  struct Watched {
    SeenStream stream;
    RateMeter meter{100'000};
    cdr::Layout layout;
    std::string type;
    const dds::RawSubscription* reader = nullptr;
    std::vector<double> delays_s = {};
  };

  void follow();
  void read_when_published(const std::string& topic);
  void note(Watched& watched, const dds::RawType::Bytes& bytes);
  void note_message(Watched& watched, const cdr::Value& message);
  SeenStream finished(const Watched& watched) const;
  const Watched* find(const std::string& topic) const;
  SeenCamera camera(const std::string& what) const;
  std::vector<std::string> watched_topics() const;

  Domain& domain_;
  std::map<std::string, Watched> watched_;  ///< by name; stays where it is
  std::map<std::string, SeenCameraInfo> infos_;
  std::vector<SeenTransform> static_transforms_;
  std::optional<std::int64_t> clock_ns_;
  std::int64_t system_ns_ = 0;
  double seconds_ = 0.0;
  bool is_counting_ = false;
};

}  // namespace lapis::command_line
