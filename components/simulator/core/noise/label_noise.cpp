#include "simulator/core/noise/label_noise.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/noise/rounded.hpp"

namespace lapis::simulator {
namespace {

using geometry::Image;
using geometry::LabelImage;

/// Groups of classes that are easily confused with each other.
const std::vector<std::vector<std::string_view>>& groups() {
  static const std::vector<std::vector<std::string_view>> all{
      {"chair", "sofa", "stool", "seating", "bed", "cushion"},
      {"table", "counter", "furniture", "chest_of_drawers", "cabinet", "shelving", "appliances", "fireplace"},
      {"wall", "ceiling", "column", "beam", "board_panel", "picture", "mirror", "window", "blinds", "curtain", "door"},
      {"objects", "misc", "clothes", "towel", "cushion", "plant", "lighting"},
      {"sink", "bathtub", "toilet", "shower", "counter"},
      {"tv_monitor", "picture", "board_panel", "window", "mirror"},
      {"floor", "wall", "table", "stairs", "railing"},
      {"gym_equipment", "furniture", "objects"}};
  return all;
}

unsigned groups_of(std::string_view name) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < groups().size(); ++i) {
    const auto& names = groups()[i];
    if (std::find(names.begin(), names.end(), name) != names.end()) bits |= 1U << i;
  }
  return bits;
}

struct NamedValue {
  std::string_view name;
  double value;
};

template <std::size_t N>
double value_of(std::string_view name, const std::array<NamedValue, N>& values, double otherwise) {
  const auto found = std::find_if(values.begin(), values.end(), [name](const auto& v) { return v.name == name; });
  return found == values.end() ? otherwise : found->value;
}

// Values of the prototype on which the default configuration is based.
constexpr std::array<NamedValue, 11> kBonus{{{"wall", 0.10},
                                             {"floor", 0.12},
                                             {"ceiling", 0.10},
                                             {"sofa", 0.05},
                                             {"bed", 0.05},
                                             {"objects", -0.20},
                                             {"furniture", -0.20},
                                             {"lighting", -0.10},
                                             {"towel", -0.15},
                                             {"clothes", -0.15},
                                             {"mirror", -0.20}}};
constexpr std::array<NamedValue, 4> kAppeal{{{"wall", 2.0}, {"objects", 1.2}, {"unlabeled", 0.0}, {"void", 0.0}}};
constexpr double kOtherAppeal = 0.15, kSharedGroup = 4.0;
constexpr double kMinAccuracy = 0.05;

/// Smooth random displacement of every pixel: normal numbers at 20 x 12 nodes, interpolated so that their variance is
/// the same everywhere.
class BoundaryFlow {
 public:
  BoundaryFlow(int width, int height, double sigma_px, const Random& random)
      : width_(width), height_(height), across_(static_cast<std::size_t>(width)) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto index = static_cast<std::uint64_t>(2 * i);
      nodes_[i] = {static_cast<float>(sigma_px * random.normal(index)),
                   static_cast<float>(sigma_px * random.normal(index + 1))};
    }
    for (int column = 0; column < width; ++column)
      across_[static_cast<std::size_t>(column)] = between(column, width, kColumns);
  }

  /// For every pixel of a row, the index of the pixel whose label it shows.
  void sources(int row, std::vector<std::size_t>& indices) const {
    const Between y = between(row, height_, kRows);
    std::array<Offset, kColumns> nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Offset &a = nodes_[y.node * kColumns + i], &b = nodes_[(y.node + 1) * kColumns + i];
      nodes[i] = {y.first * a.x + y.second * b.x, y.first * a.y + y.second * b.y};
    }
    for (int column = 0; column < width_; ++column) {
      const Between& x = across_[static_cast<std::size_t>(column)];
      const Offset &a = nodes[x.node], &b = nodes[x.node + 1];
      const int from_column = std::clamp(column + rounded(x.first * a.x + x.second * b.x), 0, width_ - 1);
      const int from_row = std::clamp(row + rounded(x.first * a.y + x.second * b.y), 0, height_ - 1);
      indices[static_cast<std::size_t>(column)] =
          static_cast<std::size_t>(from_row) * across_.size() + static_cast<std::size_t>(from_column);
    }
  }

 private:
  static constexpr int kColumns = 20, kRows = 12;
  struct Offset {
    float x, y;
  };
  struct Between {
    std::size_t node;     // the first of two neighbouring nodes
    float first, second;  // weights of the two; their squares sum to 1
  };
  static Between between(int pixel, int pixels, int nodes) {
    const double position = static_cast<double>(pixel) * (nodes - 1) / std::max(pixels - 1, 1);
    const int node = std::min(static_cast<int>(position), nodes - 2);
    const double t = position - node, norm = std::hypot(1 - t, t);
    return {static_cast<std::size_t>(node), static_cast<float>((1 - t) / norm), static_cast<float>(t / norm)};
  }

  int width_, height_;
  std::array<Offset, std::size_t{kColumns} * kRows> nodes_;
  std::vector<Between> across_;
};

/// Key of a run, and of the cell of 1 m x 1 m x 45 degrees from which the camera looks.
std::uint64_t cell_key(std::uint64_t seed, const geometry::Pose& T_world_camera) {
  constexpr double kCell_m = 1.0, kOctants = 8.0;
  const Eigen::Vector3d forward = T_world_camera.linear().col(2);
  const double octant = std::floor(std::atan2(forward.y(), forward.x()) / (2 * std::numbers::pi / kOctants));
  const Eigen::Vector3d cell(std::floor(T_world_camera.translation().x() / kCell_m),
                             std::floor(T_world_camera.translation().y() / kCell_m),
                             octant - kOctants * std::floor(octant / kOctants));
  std::uint64_t key = seed;
  for (const double part : cell)  // + 0.0, because minus zero is the same cell
    key = Random(key, RandomStream::kLabelConfusion, std::bit_cast<std::uint64_t>(part + 0.0)).bits(0);
  return key;
}

}  // namespace

LabelNoise::LabelNoise(const LabelNoiseConfig& config, const mapping::LabelList& list, std::uint64_t seed)
    : config_(config), seed_(seed) {
  for (const mapping::Label& label : list.labels()) {
    classes_.push_back({label.id, groups_of(label.name), value_of(label.name, kBonus, 0.0),
                        value_of(label.name, kAppeal, kOtherAppeal)});
  }
}

double LabelNoise::weight(const Class& truth, const Class& other) {
  if (truth.id == other.id || other.appeal == 0.0) return 0.0;
  if (truth.groups == 0) return 1.0;
  return other.appeal + kSharedGroup * std::popcount(truth.groups & other.groups);
}

const LabelNoise::Class* LabelNoise::find(std::uint16_t class_id) const {
  const auto found = std::lower_bound(classes_.begin(), classes_.end(), class_id,
                                      [](const Class& c, std::uint16_t id) { return c.id < id; });
  return found != classes_.end() && found->id == class_id && found->appeal > 0.0 ? &*found : nullptr;
}

double LabelNoise::accuracy(std::uint16_t class_id, double range_m, int pixels) const {
  const Class* truth = find(class_id);
  if (truth == nullptr) return 1.0;
  const double far_m = std::max(range_m - config_.free_range_m, 0.0);
  const double small = pixels < config_.small_px ? config_.small_loss : 0.0;
  return std::clamp(config_.accuracy + truth->bonus - config_.range_loss_per_m * far_m - small, kMinAccuracy, 1.0);
}

double LabelNoise::confusion(std::uint16_t class_id, std::uint16_t other) const {
  const Class *truth = find(class_id), *taken = find(other);
  if (truth == nullptr || taken == nullptr) return 0.0;
  double sum = 0.0;
  for (const Class& c : classes_) sum += weight(*truth, c);
  return sum > 0.0 ? weight(*truth, *taken) / sum : 0.0;
}

/// The class at which the cumulative confusion exceeds `share`.
std::uint16_t LabelNoise::draw_other(const Class& truth, double share) const {
  double sum = 0.0;
  for (const Class& c : classes_) sum += weight(truth, c);
  double rest = share * sum;
  std::uint16_t drawn = truth.id;  // stays when there is no other class
  for (const Class& c : classes_) {
    const double w = weight(truth, c);
    if (w > 0.0) drawn = c.id;
    rest -= w;
    if (w > 0.0 && rest < 0.0) break;
  }
  return drawn;
}

/// Class, number of pixels and depth of every instance in the image; it sums up runs of pixels of one instance.
std::vector<LabelNoise::Sight> LabelNoise::look(const LabelImage& labels, const Image<std::uint16_t>& instances,
                                                const geometry::DepthImage& depth) {
  std::vector<Sight> sights(1);
  const std::size_t size = instances.pixels.size();
  for (std::size_t i = 0; i < size;) {
    const std::uint16_t instance = instances.pixels[i];
    const std::size_t first = i;
    float sum = 0.0F;
    int measured = 0;
    for (; i < size && instances.pixels[i] == instance; ++i) {
      sum += depth.pixels[i];
      measured += static_cast<int>(depth.pixels[i] > 0.0F);
    }
    if (instance >= sights.size()) sights.resize(instance + std::size_t{1});
    Sight& sight = sights[instance];
    sight.class_id = labels.pixels[first];
    sight.pixels += static_cast<int>(i - first);
    sight.depth_sum_m += static_cast<double>(sum);
    sight.measured += measured;
  }
  return sights;
}

/// The class that one instance gets in a frame.
std::uint16_t LabelNoise::recognise(const Sight& sight, const Random& in_cell, const Random& in_frame) const {
  const Class* truth = find(sight.class_id);
  if (truth == nullptr) return sight.class_id;
  if (in_frame.uniform(0) < config_.flip) return draw_other(*truth, in_frame.uniform(1));
  const double range_m = sight.depth_sum_m / std::max(sight.measured, 1);
  if (in_cell.uniform(0) < accuracy(sight.class_id, range_m, sight.pixels)) return sight.class_id;
  return draw_other(*truth, in_cell.uniform(1));
}

LabelImage LabelNoise::apply(const LabelImage& labels, const Image<std::uint16_t>& instances,
                             const geometry::DepthImage& depth, const geometry::Pose& T_world_camera,
                             std::uint64_t tick) const {
  if (config_.model == LabelModel::kNone) return labels;
  const int width = labels.width, height = labels.height;
  if (instances.width != width || instances.height != height || depth.width != width || depth.height != height)
    throw std::invalid_argument("label noise: labels, instances and depth must have one image size");
  const std::vector<Sight> sights = look(labels, instances, depth);
  const std::uint64_t cell = cell_key(seed_, T_world_camera);
  const std::uint64_t frame = Random(seed_, RandomStream::kLabelFlip, tick).bits(0);
  std::vector<std::uint16_t> taken_for(sights.size(), 0);
  for (std::size_t i = 1; i < sights.size(); ++i) {
    if (sights[i].pixels == 0) continue;
    taken_for[i] = recognise(sights[i], Random(cell, RandomStream::kLabelConfusion, i),
                             Random(frame, RandomStream::kLabelFlip, i));
  }
  const BoundaryFlow flow(width, height, config_.warp_px, Random(seed_, RandomStream::kLabelBoundary, tick));
  LabelImage result(width, height);
  std::vector<std::size_t> sources(static_cast<std::size_t>(width));
  std::size_t i = 0;
  for (int row = 0; row < height; ++row) {
    flow.sources(row, sources);
    for (const std::size_t source : sources) {
      if (instances.pixels[i] != 0) result.pixels[i] = taken_for[instances.pixels[source]];
      ++i;
    }
  }
  return result;
}

}  // namespace lapis::simulator
