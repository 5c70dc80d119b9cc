#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command_line/core/graph.hpp"
#include "command_line/interruption.hpp"
#include "command_line/settings.hpp"
#include "common/dds/executor.hpp"
#include "common/dds/participant.hpp"
#include "idl/rmw_dds_common.hpp"

namespace lapis::command_line {

using Seconds = std::chrono::duration<double>;

/// The DDS domain that a command looks at. Nothing happens in the background: samples are handled while it waits.
class Domain {
 public:
  /// Throws std::runtime_error where the environment or the settings make no sense.
  explicit Domain(const Settings& settings);
  ~Domain();
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  /// Handles samples until the condition holds; false at the deadline, or when the user has interrupted. It asks again
  /// after each sample, and when discovery or matching has changed.
  bool wait_until(const std::function<bool()>& condition, Seconds longest);
  /// Waits until discovery finds nothing more: until something has been found and nothing has changed for half a
  /// second, or at the latest until the time is over that the settings give.
  void settle();
  bool is_interrupted() const { return interruption_.has_come(); }

  /// Readers and writers of other processes.
  std::vector<dds::Endpoint> endpoints() const;
  /// The same as ROS 2 shows them: topics, without services.
  std::vector<SeenEndpoint> seen() const;
  std::vector<SeenService> services() const;
  /// Full name of the node to which an endpoint belongs; empty: unknown.
  std::string node_of(const dds::Gid& endpoint) const;
  /// Number of other participants whose endpoints are there.
  std::size_t participants() const;
  /// Full names of the nodes, sorted.
  std::vector<std::string> nodes() const;

  /// The name that a user means: "/a/b" as it is, "a/b" in the robot's namespace.
  std::string full_name(const std::string& name) const;
  dds::Participant& participant() { return participant_; }
  const dds::Names& names() const { return participant_.names(); }
  const Settings& settings() const { return settings_; }
  Seconds patience() const { return Seconds(settings_.wait_s); }

  /// Makes a reader and lets it take part in waiting.
  template <class Source, class... Arguments>
  Source& add(Arguments&&... arguments) {
    auto source = std::make_unique<Source>(participant_, std::forward<Arguments>(arguments)...);
    Source& reference = *source;
    executor_.add(reference);
    sources_.push_back(std::move(source));
    return reference;
  }

 private:
  using Graph = rmw_dds_common::msg::ParticipantEntitiesInfo;
  void note_nodes(const Graph& graph);
  bool is_own(const dds::Gid& gid) const;

  Settings settings_;
  Interruption interruption_;  // before threads of DDS
  dds::Participant participant_;
  dds::Executor executor_;
  std::vector<std::unique_ptr<dds::Source>> sources_;
  std::map<dds::Gid, std::map<dds::Gid, std::string>> nodes_;  ///< by participant: the node of each endpoint
};

}  // namespace lapis::command_line
