#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/mapping/file/map_file.hpp"
#include "common/runtime/saved_map.hpp"
#include "idl/std_srvs.hpp"
#include "semantic_mapper/core/frame_journal.hpp"
#include "semantic_mapper/frame_input.hpp"
#include "semantic_mapper/map_publisher.hpp"
#include "semantic_mapper/semantic_mapper_config.hpp"

namespace lapis::semantic_mapper {

/// Fuses depth and labels at the poses that slam publishes, publishes the map and keeps it on disk.
class SemanticMapperComponent {
 public:
  using Config = SemanticMapperComponentConfig;
  static constexpr const char* kName = "semantic_mapper";
  static constexpr const char* kSummary = "Semantic voxel map that follows the pose graph.";

  static config::Rules rules(const Config& config);

  SemanticMapperComponent(const Config& config, runtime::Context& context);
  /// From the next cycle on.
  void reconfigure(const Config& config);
  void finish();

 private:
  using Tracked = lapis_msgs::msg::TrackedFrame;
  using Graph = lapis_msgs::msg::PoseGraph;

  void load_map();
  void rebuild_map();
  void set_labels(const vision_msgs::msg::LabelInfo& message);
  void work(const runtime::Cycle& cycle);
  void take_frames(bool is_last_chance);
  void integrate(SeenFrame seen);
  void see_obstacles(SeenFrame& seen);
  bool is_of_other_map(const Tracked& tracked) const;
  std::optional<IntegrationReport> enter(AnchoredFrame frame);
  void keep_unconnected(const Tracked& tracked, mapping::CompactFrame frame);
  void enter_placed_frames(std::size_t most);
  void keep_newest_frame(const std::optional<std::vector<std::uint8_t>>& packed);
  void follow_graph(const Graph& graph);
  void report_store(const FrameStore& store);
  void report_drift();
  void log_drift() const;
  void drop(const std::string& reason);
  void start_new_map(std::int64_t session, time::Time stamp);
  void end_map();
  void follow_clock(time::Duration step, time::Time first);
  void forget_resumed();
  std::unique_ptr<SemanticMapper> begin_map(std::int64_t session);
  void begin_journal(std::int64_t session);
  void save_when_due();
  std_srvs::srv::Trigger_Response save_on_request();
  void flush();
  /// Nothing on success; otherwise what failed, naming the file.
  std::optional<std::string> save();
  std::optional<std::string> write_files();
  void report_disk();

  Config config_;
  runtime::Context& context_;
  MapPublisher publisher_;

  FrameInput input_;
  std::optional<Graph> graph_;  // newest one, not applied yet
  mapping::LabelList label_list_;

  runtime::SavedMap disk_;
  std::optional<mapping::MapFile> resumed_;     // until the first map begins with it
  std::optional<JournalSummary> rebuilt_from_;  // the same for a map that was rebuilt from frames
  std::unique_ptr<SemanticMapper> rebuilt_;
  mapping::LabelList resumed_labels_;
  std::uint64_t resumed_frames_ = 0;
  bool is_mixed_ = false;  // the resumed map has counts of frames with other settings, or with unknown ones
  std::optional<FrameJournal> journal_;      // of mapper_, if frames are kept
  std::optional<std::string> save_problem_;  // why the newest save failed
  std::optional<std::string> keep_problem_;  // why the newest frame is not in the journal

  std::unique_ptr<SemanticMapper> mapper_;  // exists once slam tracks
  UnconnectedFrames unconnected_;           // of its session
  MapProgress progress_;
};

}  // namespace lapis::semantic_mapper
