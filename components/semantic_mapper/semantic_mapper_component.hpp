#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "common/mapping/file/map_file.hpp"
#include "common/runtime/saved_map.hpp"
#include "common/runtime/stamped_input.hpp"
#include "idl/std_srvs.hpp"
#include "semantic_mapper/conversions.hpp"
#include "semantic_mapper/core/floor_plan.hpp"
#include "semantic_mapper/core/frame_journal.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
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
  void finish();

 private:
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;
  using Tracked = lapis_msgs::msg::TrackedFrame;
  using Graph = lapis_msgs::msg::PoseGraph;

  void load_map();
  void rebuild_map();
  mapping::FrameSettings frame_settings() const;
  void describe_map();
  void set_labels(const vision_msgs::msg::LabelInfo& message);
  void work(const runtime::Cycle& cycle);
  bool next_frame(const runtime::Cycle& cycle);
  void integrate(const Tracked& tracked, const Image& depth, const Image* labels, const Image* confidence,
                 const Info& info);
  void keep_newest_frame(const std::optional<std::vector<std::uint8_t>>& packed);
  void follow_graph(const Graph& graph);
  void report_store(const FrameStore& store);
  void report_drift();
  void log_drift() const;
  void drop(const std::string& reason);
  void start_new_map(std::int64_t session, time::Time stamp);
  void begin_epoch(time::Time stamp);
  void end_map();
  void follow_clock(time::Duration step);
  void forget_resumed();
  std::unique_ptr<SemanticMapper> begin_map(std::int64_t session);
  void begin_journal(std::int64_t session);
  void publish(bool is_final);
  void publish_tiles();
  void publish_obstacles();
  void publish_provisional_area();
  void publish_views(bool is_due);
  bool wants_view(const dds::Writer& writer, bool is_due);
  std_srvs::srv::Trigger_Response save_on_request();
  void flush();
  /// Nothing on success; otherwise what failed, naming the file.
  std::optional<std::string> save();
  std::optional<std::string> write_files();
  void report_disk();
  mapping::BeliefReader belief_reader() const;
  std_msgs::msg::Header header(time::Time stamp) const;

  Config config_;
  runtime::Context& context_;
  dds::Publisher<lapis_msgs::msg::MapDescription>& map_description_;
  dds::Publisher<lapis_msgs::msg::VoxelTile>& tiles_;
  dds::Publisher<lapis_msgs::msg::MapState>& map_state_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& obstacles_;
  dds::Publisher<octomap_msgs::msg::Octomap>& octomap_;
  dds::Publisher<sensor_msgs::msg::PointCloud2>& points_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& grid_;
  dds::Publisher<nav_msgs::msg::OccupancyGrid>& provisional_;

  runtime::StampedInput<Tracked> tracked_;
  runtime::StampedInput<Image> depth_;
  runtime::StampedInput<Image> labels_;
  runtime::StampedInput<Image> confidence_;
  runtime::StampedInput<Info> info_;
  std::optional<Graph> graph_;  // newest one, not applied yet
  mapping::LabelList label_list_;
  std::optional<mapping::MapDescription> described_;  // published last

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
  std::optional<FloorPlan> floor_plan_;     // of mapper_
  std::optional<ObstacleLayer> obstacle_layer_;
  std::int64_t session_ = 0;
  std::int64_t epoch_ = 0;
  time::Time stamp_;                       // of the newest integrated frame
  time::Time published_stamp_;             // of the newest frame that slam published
  std::optional<time::Time> tiles_stamp_;  // published last
  std::optional<time::Time> views_stamp_;
  std::optional<time::Time> obstacles_stamp_;
  std::optional<time::Time> provisional_stamp_;
  time::Duration clock_steps_;                           // sum of the steps by which the clock of the frames was set
  OccupancyGrid provisional_area_;                       // published last
  std::optional<std::uint64_t> provisional_changes_;     // count of changes at the last look
  std::set<std::tuple<int, int, int>> published_tiles_;  // of this epoch
  std::map<const dds::Writer*, std::uint64_t> seen_matches_;
  std::uint64_t frames_integrated_ = 0;
  std::uint64_t frames_dropped_ = 0;
};

}  // namespace lapis::semantic_mapper
