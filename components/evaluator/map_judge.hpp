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

/// The map that the mapper publishes and its references: a map that the same algorithm builds from true poses, a plain
/// fusion, and the ground truth of a simulated scene. All are in the run's map frame.
class MapJudge {
 public:
  /// @param truth_folder where the simulator writes the ground truth of the scene, if there is one
  explicit MapJudge(std::filesystem::path truth_folder) : truth_folder_(std::move(truth_folder)) {}

  mapping::MapMirror& mirror() { return mirror_; }
  /// Sessions of slam: the one in which the run is judged, and the one to which the newest map belongs.
  void set_judged_session(std::int64_t session) { judged_session_ = session; }
  void set_map_session(std::int64_t session) { map_session_ = session; }
  /// Sets the mapper's description of its map, without which there are no references and no map is read. Returns the
  /// difference from the previous description that makes the maps of the run incomparable, or an empty text.
  std::string set_description(mapping::MapDescription description);

  /// Adds a frame that slam tracked to the references, at its true pose. Frames that slam did not track are not in the
  /// map and must not be added. Labels may be empty. Returns the problem with the frame, or an empty text.
  std::string add_reference_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth_m,
                                  const geometry::LabelImage& labels, const geometry::Pose& T_map_camera);
  /// Loads the ground truth of the scene, which the simulator writes during the run, once it is available. Returns the
  /// problem with it, or an empty text.
  std::string find_truth(const geometry::Pose& T_map_world);

  /// Explored share of the current map; none without a map or ground truth.
  std::optional<double> explored_share() const;
  /// Fills in the explored volume, and remembers the map for add_shares().
  void write_to(TimelineRow& row);
  /// Fills in the explored shares of all rows that write_to() has filled.
  void add_shares(std::vector<TimelineRow>& rows) const;
  /// Fills in the figures of maps.
  /// @param has_reference whether the pose of the map frame in the world is known
  void write_to(RunMetrics& metrics, bool has_reference) const;
  /// Throws std::runtime_error when the file cannot be written.
  void save_reference(const std::filesystem::path& file) const;

 private:
  /// Maps of the run's own frames at true poses.
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
  std::optional<GroundTruth> truth_;  // ground truth of a simulated scene
  KnownHistory known_;                // known voxels of the rows that have a comparable map
};

}  // namespace lapis::evaluator
