#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/mapping/file/map_description.hpp"
#include "common/mapping/wire/map_mirror.hpp"
#include "evaluator/core/map/coverage.hpp"
#include "evaluator/core/map/ground_truth.hpp"
#include "evaluator/core/map/plain_fusion.hpp"
#include "evaluator/core/run/metrics.hpp"
#include "evaluator/core/run/timeline.hpp"

namespace lapis::evaluator {

/// The map that the mapper publishes, and what it is judged by: the same mapper's map from true poses, a plain fusion,
/// and the ground truth of a simulated scene. All are in the run's map frame.
class MapJudge {
 public:
  /// @param truth_folder where the simulator writes the ground truth of the scene, if there is one
  explicit MapJudge(std::filesystem::path truth_folder) : truth_folder_(std::move(truth_folder)) {}

  mapping::MapMirror& mirror() { return mirror_; }
  /// Of slam: the one that the run is judged by, and the one that the newest map is of.
  void set_judged_session(std::int64_t session) { judged_session_ = session; }
  void set_map_session(std::int64_t session) { map_session_ = session; }
  /// What the mapper says of its map; without it there are no references, and no map is read. Returns what of it
  /// differs from what it said before, so that maps of one run could not be compared; else an empty text.
  std::string set_description(mapping::MapDescription description);

  /// A frame that slam tracked, at its true pose: the references judge the map, so only what the map can hold is in
  /// them. Labels may be empty. Returns what is wrong with the frame, or an empty text.
  std::string add_reference_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth_m,
                                  const geometry::LabelImage& labels, const geometry::Pose& T_map_camera);
  /// Looks for the ground truth of the scene, which the simulator writes while the run continues. Returns what is wrong
  /// with it, or an empty text.
  std::string find_truth(const geometry::Pose& T_map_world);

  /// Of the map as it is; none without a map or ground truth.
  std::optional<double> explored_share() const;
  /// Fills in the explored volume, and remembers the map for its share.
  void write_to(TimelineRow& row);
  /// Fills in the explored share of all rows that were written to.
  void add_shares(std::vector<TimelineRow>& rows) const;
  /// Fills in what RunMetrics has of maps.
  /// @param has_reference whether the map frame's place in the world is known
  void write_to(RunMetrics& metrics, bool has_reference) const;
  /// Throws std::runtime_error when it cannot be written.
  void save_reference(const std::filesystem::path& file) const;

 private:
  /// What the run's own frames give at true poses.
  struct References {
    explicit References(const mapping::MapDescription& description);
    mapping::VoxelMap map;
    PlainFusion plain_fusion;
  };

  bool is_map_known() const { return description_ && mirror_.map() != nullptr; }
  mapping::BeliefReader belief_reader() const { return mapping::BeliefReader(description_->sensor_model); }
  bool is_comparable(const KnownSpace& map) const;
  std::optional<LabelledVoxels> load_exact(const std::string& name) const;

  std::filesystem::path truth_folder_;
  std::optional<mapping::MapDescription> description_;
  mapping::MapMirror mirror_;
  std::optional<std::int64_t> judged_session_, map_session_;
  std::optional<References> references_;
  std::optional<GroundTruth> truth_;  // of a simulated scene
  KnownHistory known_;                // of the rows that have a comparable map
};

}  // namespace lapis::evaluator
