#include "sensor_replay/core/tum_dataset.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <system_error>

namespace lapis::sensor_replay {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

std::vector<ListedImage> read_required_list(const fs::path& file) {
  if (!fs::is_regular_file(file)) {
    fail(file, "not found; a TUM RGB-D folder has rgb.txt and depth.txt (or associations.txt), camera.yaml and images");
  }
  std::vector<ListedImage> images = read_image_list(file);
  if (images.empty()) fail(file, "lists no image");
  return images;
}

// Moves the image out of a reader's answer, or notes the reason why there is none.
template <class Image>
std::optional<Image> take(std::variant<Image, ImageFault> answer, ImagePart part, const fs::path& file,
                          std::vector<ImageProblem>& problems) {
  if (auto* image = std::get_if<Image>(&answer)) return std::move(*image);
  problems.push_back({part, std::get<ImageFault>(answer), file});
  return std::nullopt;
}

}  // namespace

std::string to_string(const ImageProblem& problem) {
  constexpr const char* kNames[] = {"colour", "depth", "label"};
  const std::string name = kNames[static_cast<std::size_t>(problem.part)];
  return (problem.file.empty() ? name : name + " " + problem.file.string()) + ": " + to_string(problem.fault);
}

TumDataset::TumDataset(const TumDatasetConfig& config, const CameraReader& read_camera) : config_(config) {
  if (config.max_stamp_difference_s < 0.0 || config.max_stamp_difference_s > 1.0) {
    throw std::runtime_error("max_stamp_difference_s: must be from 0 to 1");
  }
  if (!fs::is_directory(config.folder)) fail(config.folder, "no such folder (expected a TUM RGB-D data set)");
  read_frames();
  camera_ = read_camera(config.folder / "camera.yaml");
  const geometry::LensCamera lens{camera_.camera, {camera_.distortion.begin(), camera_.distortion.end()}};
  rectifier_.emplace(lens);
  depth_rectifier_.emplace(camera_.depth_camera ? camera_.depth_camera->camera : lens);
  const fs::path truth = config.folder / "groundtruth.txt";
  if (fs::exists(truth)) trajectory_ = trajectory::read_trajectory(truth);
  has_labels_ = config.takes_labels && fs::is_directory(config.folder / "label");
  if (!config.class_list.empty()) {
    class_list_ = read_class_list(config.class_list);
  } else if (fs::exists(config.folder / "classes.csv")) {
    class_list_ = read_class_list(config.folder / "classes.csv");
  }
  check_images();
  check_image_size();
}

void TumDataset::read_frames() {
  const fs::path associations = config_.folder / "associations.txt";
  if (fs::exists(associations)) {
    frames_ = read_associations(associations);
    if (frames_.empty()) fail(associations, "lists no frame");
    return;
  }
  const auto color = read_required_list(config_.folder / "rgb.txt");
  const auto depth = read_required_list(config_.folder / "depth.txt");
  frames_ = pair_by_stamp(color, depth, time::Duration::from_seconds(config_.max_stamp_difference_s));
  if (frames_without_depth() == frames_.size()) {
    fail(config_.folder / "depth.txt", "no depth image within " + std::to_string(config_.max_stamp_difference_s) +
                                           " s of any colour image; are both lists on the same clock?");
  }
}

// A single missing image is a flaw of the data, but when all images of a kind are missing, the set-up is wrong.
void TumDataset::check_images() const {
  const std::vector<ImageProblem> missing = missing_images();
  const auto check = [&](ImagePart part, std::size_t listed, const char* remedy) {
    const auto is_part = [&](const ImageProblem& problem) { return problem.part == part; };
    const auto count = static_cast<std::size_t>(std::count_if(missing.begin(), missing.end(), is_part));
    if (listed == 0 || count < listed) return;
    const auto first = std::find_if(missing.begin(), missing.end(), is_part);
    fail(config_.folder / first->file,
         "missing, and so are all " + std::to_string(listed) + " images of its kind; " + remedy);
  };
  constexpr const char* kListRemedy = "file names in the lists are relative to the data set's folder";
  check(ImagePart::kColor, size(), kListRemedy);
  check(ImagePart::kDepth, size() - frames_without_depth(), kListRemedy);
  check(ImagePart::kLabel, has_labels_ ? size() : 0, "name label images after the colour images, or remove the folder");
}

// Otherwise a wrong camera.yaml would give a replay in which every frame is skipped.
void TumDataset::check_image_size() const {
  for (const std::size_t index : {std::size_t{0}, size() / 2, size() - 1}) {
    const fs::path file = config_.folder / frames_[index].color.file;
    const auto answer = read_size(file);
    const auto* found = std::get_if<ImageSize>(&answer);
    if (!found) continue;
    if (*found == image_size()) return;
    if (index != size() - 1) continue;
    const auto text = [](ImageSize s) { return std::to_string(s.width) + "x" + std::to_string(s.height); };
    fail(config_.folder / "camera.yaml",
         "width and height say " + text(image_size()) + ", but " + frames_[index].color.file + " has " + text(*found));
  }
}

fs::path TumDataset::label_file(std::size_t index) const {
  return fs::path("label") / fs::path(frames_[index].color.file).filename().replace_extension(".png");
}

ImageSize TumDataset::depth_size() const {
  if (!camera_.depth_camera) return image_size();
  const auto& camera = camera_.depth_camera->camera.pinhole;
  return {camera.width, camera.height};
}

std::size_t TumDataset::frames_without_depth() const {
  return static_cast<std::size_t>(
      std::count_if(frames_.begin(), frames_.end(), [](const ListedFrame& frame) { return !frame.depth; }));
}

std::optional<geometry::Pose> TumDataset::ground_truth(std::size_t index) const {
  return trajectory::pose_at(trajectory_, stamp(index), time::Duration::from_seconds(config_.max_stamp_difference_s));
}

std::vector<ImageProblem> TumDataset::missing_images() const {
  std::vector<ImageProblem> missing;
  const auto check = [&](ImagePart part, const fs::path& file) {
    std::error_code error;  // "permission denied" counts as missing, too
    if (!fs::is_regular_file(config_.folder / file, error)) missing.push_back({part, ImageFault::kMissing, file});
  };
  for (std::size_t i = 0; i < size(); ++i) {
    check(ImagePart::kColor, frames_[i].color.file);
    if (frames_[i].depth) check(ImagePart::kDepth, frames_[i].depth->file);
    if (has_labels_) check(ImagePart::kLabel, label_file(i));
  }
  return missing;
}

LoadedFrame TumDataset::load_frame(std::size_t index) const {
  const ListedFrame& listed = frames_.at(index);
  auto color = read_color(config_.folder / listed.color.file, image_size());
  if (const auto* fault = std::get_if<ImageFault>(&color)) {
    return SkippedFrame{index, listed.color.stamp, {ImagePart::kColor, *fault, listed.color.file}};
  }
  ReplayFrame frame;
  frame.index = index;
  frame.stamp = listed.color.stamp;
  frame.color = std::move(std::get<geometry::ColorImage>(color));
  rectifier_->rectify(frame.color);
  frame.T_world_camera = ground_truth(index);
  if (listed.depth) {
    frame.depth = take(read_depth(config_.folder / listed.depth->file, depth_size(), camera_.depth_scale),
                       ImagePart::kDepth, listed.depth->file, frame.problems);
    if (frame.depth) depth_rectifier_->rectify(*frame.depth);
  } else {
    frame.problems.push_back({ImagePart::kDepth, ImageFault::kNotListed, {}});
  }
  if (has_labels_) {
    const fs::path file = label_file(index);
    frame.label = take(read_label(config_.folder / file, image_size()), ImagePart::kLabel, file, frame.problems);
    if (frame.label) rectifier_->rectify(*frame.label);
  }
  return frame;
}

std::vector<ClassName> TumDataset::classes() const {
  if (!has_labels_ || !class_list_.empty()) return has_labels_ ? class_list_ : std::vector<ClassName>{};
  std::set<std::uint16_t> ids;
  for (std::size_t i = 0; i < size(); ++i) {
    const auto answer = read_label(config_.folder / label_file(i), image_size());
    const auto* label = std::get_if<geometry::LabelImage>(&answer);
    if (label) ids.insert(label->pixels.begin(), label->pixels.end());
  }
  ids.erase(0);
  std::vector<ClassName> classes;
  std::transform(ids.begin(), ids.end(), std::back_inserter(classes), unnamed_class);
  return classes;
}

FrameRange TumDataset::select(time::Duration start, std::optional<time::Duration> duration) const {
  const auto first_at = [&](time::Time t) {
    const auto frame = std::lower_bound(frames_.begin(), frames_.end(), t,
                                        [](const ListedFrame& f, time::Time limit) { return f.color.stamp < limit; });
    return static_cast<std::size_t>(frame - frames_.begin());
  };
  const time::Time begin = stamp(0) + start;
  const FrameRange range{first_at(begin), duration ? first_at(begin + *duration) : size()};
  if (range.begin >= range.end) {
    fail(config_.folder,
         "no frame in the selected time; the data set lasts " + std::to_string(this->duration().seconds()) + " s");
  }
  return range;
}

}  // namespace lapis::sensor_replay
