#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/mapping/label_list.hpp"
#include "common/mapping/map_mirror.hpp"
#include "evaluator/core/coverage.hpp"
#include "evaluator/core/ground_truth.hpp"
#include "evaluator/core/metrics.hpp"
#include "evaluator/core/plain_fusion.hpp"
#include "evaluator/core/timeline.hpp"
#include "evaluator/evaluator_config.hpp"

namespace lapis::evaluator {

/// The map that the mapper tells, and what it is judged by: the same mapper's map from true poses, a plain fusion, and
/// the ground truth of a simulated scene. All are in the run's map frame.
class MapJudge {
 public:
  /// Throws std::runtime_error naming the value that is out of range.
  explicit MapJudge(const EvaluatorConfig& config);

  mapping::MapMirror& mirror() { return mirror_; }
  /// Of slam: the one that the run is judged by, and the one that the newest map is of.
  void set_judged_session(std::int64_t session) { judged_session_ = session; }
  void set_map_session(std::int64_t session) { map_session_ = session; }
  void set_labels(mapping::LabelList labels);

  /// A frame that slam tracked, at its true pose: the references judge the map, so only what the map can hold is in
  /// them. Labels may be empty. Returns what is wrong with the frame, or an empty text.
  std::string add_reference_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth_m,
                                  const geometry::LabelImage& labels, const geometry::Pose& T_map_camera);
  /// Looks for the ground truth of the scene, which the simulator writes while the run goes on. Returns what is wrong
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
  mapping::BeliefReader belief_reader() const;
  std::filesystem::path truth_folder() const;
  bool is_comparable(const KnownSpace& map) const;
  std::optional<LabelledVoxels> load_ideal() const;

  EvaluatorConfig config_;
  mapping::LabelList labels_;
  mapping::MapMirror mirror_;
  std::optional<std::int64_t> judged_session_, map_session_;
  mapping::VoxelMap reference_;
  PlainFusion plain_fusion_;
  std::optional<GroundTruth> truth_;  // of a simulated scene
  KnownHistory known_;                // of the rows that have a comparable map
};

}  // namespace lapis::evaluator
