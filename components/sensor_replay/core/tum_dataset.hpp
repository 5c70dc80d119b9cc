#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/se3.hpp"
#include "common/images/rectifier.hpp"
#include "common/time/time.hpp"
#include "common/trajectory/trajectory.hpp"
#include "sensor_replay/core/camera_file.hpp"
#include "sensor_replay/core/class_list.hpp"
#include "sensor_replay/core/image_file.hpp"
#include "sensor_replay/core/tum_lists.hpp"

namespace lapis::sensor_replay {

struct TumDatasetConfig {
  std::filesystem::path folder;
  std::filesystem::path class_list;      ///< CSV "class_id,class,..."; empty = classes.csv of the folder, if it exists
  double max_stamp_difference_s = 0.02;  ///< between colour, depth and ground truth, 0 to 1 (TUM's tools: 0.02)
  bool takes_labels = true;              ///< false: as if there were no folder label/
};

enum class ImagePart { kColor, kDepth, kLabel };

/// An image that could not be used, and why.
struct ImageProblem {
  ImagePart part = ImagePart::kColor;
  ImageFault fault = ImageFault::kMissing;
  std::filesystem::path file;  ///< empty when fault is kNotListed
};

/// "depth/00007.png: truncated or not an image".
std::string to_string(const ImageProblem& problem);

/// A decoded and rectified frame. Every image has the size of its camera.
struct ReplayFrame {
  std::size_t index = 0;
  time::Time stamp;  ///< stamp of the colour image, which is that of the whole frame
  geometry::ColorImage color;
  std::optional<DepthMillimetres> depth;         ///< as its camera sees it; empty: see `problems`
  std::optional<geometry::LabelImage> label;     ///< empty: see `problems`, or the data set has no labels
  std::optional<geometry::Pose> T_world_camera;  ///< ground truth; empty when there is none within the tolerance
  std::vector<ImageProblem> problems;            ///< problems of depth and label
};

/// A frame without a usable colour image, of which nothing can be published.
struct SkippedFrame {
  std::size_t index = 0;
  time::Time stamp;
  ImageProblem problem;
};

using LoadedFrame = std::variant<ReplayFrame, SkippedFrame>;

/// Frames [begin, end).
struct FrameRange {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t size() const { return end - begin; }
};

/// A folder in the layout of the TUM RGB-D benchmark, plus camera.yaml and optional labels. Immutable; all functions
/// may be called from several threads.
class TumDataset {
 public:
  /// Reads and checks the lists, camera.yaml (by `read_camera`), ground truth and class list; decodes three colour
  /// images to compare their size with camera.yaml. Single missing or damaged images are not an error here:
  /// `load_frame` reports them.
  /// @throws std::runtime_error, whose text names the file and the remedy in one line.
  TumDataset(const TumDatasetConfig& config, const CameraReader& read_camera);

  std::size_t size() const { return frames_.size(); }
  time::Time stamp(std::size_t index) const { return frames_[index].color.stamp; }
  /// Time from the first to the last colour image.
  time::Duration duration() const { return frames_.back().color.stamp - frames_.front().color.stamp; }
  const CameraFile& camera() const { return camera_; }
  const std::filesystem::path& folder() const { return config_.folder; }
  bool has_labels() const { return has_labels_; }
  bool has_ground_truth() const { return !trajectory_.empty(); }
  /// Number of frames without a depth image in the lists.
  std::size_t frames_without_depth() const;
  std::optional<geometry::Pose> ground_truth(std::size_t index) const;
  /// Listed images whose files do not exist now, including label images when the data set has labels.
  std::vector<ImageProblem> missing_images() const;

  /// Decodes a frame. Damaged or missing images are part of the result, never exceptions.
  LoadedFrame load_frame(std::size_t index) const;

  /// Classes from the class list; without a list, "class_<id>" for every id in the label images, which decodes all of
  /// them (a millisecond each). Sorted by id, without 0. Empty when there are no labels.
  std::vector<ClassName> classes() const;

  /// Frames from `start` after the first one, for `duration` (all when empty).
  /// @throws std::runtime_error when there is no frame in this time.
  FrameRange select(time::Duration start, std::optional<time::Duration> duration) const;

 private:
  void read_frames();
  void check_images() const;
  void check_image_size() const;
  std::filesystem::path label_file(std::size_t index) const;
  ImageSize image_size() const { return {camera_.camera.width, camera_.camera.height}; }
  ImageSize depth_size() const;

  TumDatasetConfig config_;
  CameraFile camera_;
  // Both are set in the constructor.
  std::optional<images::Rectifier> rectifier_;  // of colour and labels
  std::optional<images::Rectifier> depth_rectifier_;
  std::vector<ListedFrame> frames_;
  trajectory::Trajectory trajectory_;
  std::vector<ClassName> class_list_;
  bool has_labels_ = false;
};

}  // namespace lapis::sensor_replay
