#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/model/label_list.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {

enum class LabelModel { kNone, kDefault };

/// With the default, 64 % of the pixels on the apartment's tour have their true class. Maps of 0.25 m then have an IoU
/// with the ideal map of 0.70 in the 8 most frequent classes, and of 0.56 with 10 cm of pose error
/// (lapis_label_noise_calibration).
struct LabelNoiseConfig {
  LabelModel model = LabelModel::kDefault;
  double accuracy = 0.75;          ///< probability that an ordinary class close by is recognised, 0 to 1
  double range_loss_per_m = 0.05;  ///< loss of accuracy beyond free_range_m; >= 0
  double free_range_m = 1.5;       ///< >= 0
  double small_loss = 0.25;        ///< loss of accuracy of an instance with fewer than small_px pixels, 0 to 1
  int small_px = 160;              ///< >= 0
  double flip = 0.1;               ///< share of instances that get another class in a single frame, 0 to 1
  double warp_px = 4.0;            ///< standard deviation of the boundaries' displacement, 0 to 50
};

/// Turns true labels into those of a segmentation network. An instance is confused with another class as a whole, and
/// with the same one as long as the camera stays in a cell of 1 m and 45 degrees, so that errors do not average out;
/// boundaries wobble from frame to frame. Classes are known by their mpcat40 names: they are mostly confused with
/// similar classes; a class with another name is confused with any.
class LabelNoise {
 public:
  /// @param list the classes that the network knows
  LabelNoise(const LabelNoiseConfig& config, const mapping::LabelList& list, std::uint64_t seed);

  /// @param labels class ids, one class per instance; @param instances ids; 0: nothing there, stays unlabelled
  /// @param depth [m], of the same size; @param T_world_camera pose of the optical frame
  /// @throws std::invalid_argument when the sizes differ
  geometry::LabelImage apply(const geometry::LabelImage& labels, const geometry::Image<std::uint16_t>& instances,
                             const geometry::DepthImage& depth, const geometry::Pose& T_world_camera,
                             std::uint64_t tick) const;

  /// Probability that an instance gets its true class, without the flips of single frames. It is 1 for unlabelled
  /// instances, and for classes that are not listed.
  /// @param range_m mean depth; @param pixels number of pixels in the image
  double accuracy(std::uint16_t class_id, double range_m, int pixels) const;
  /// Probability that an instance that gets a wrong class gets `other`.
  double confusion(std::uint16_t class_id, std::uint16_t other) const;

 private:
  struct Class {
    std::uint16_t id;
    unsigned groups;  // bit set of the groups of similar classes
    double bonus;     // added to accuracy
    double appeal;    // weight with which others are confused with it; 0: "unlabeled", which nothing is confused with
  };
  struct Sight {
    std::uint16_t class_id = 0;
    int pixels = 0;
    double depth_sum_m = 0.0;
    int measured = 0;
  };
  static double weight(const Class& truth, const Class& other);
  const Class* find(std::uint16_t class_id) const;
  std::uint16_t draw_other(const Class& truth, double share) const;
  static std::vector<Sight> look(const geometry::LabelImage& labels, const geometry::Image<std::uint16_t>& instances,
                                 const geometry::DepthImage& depth);
  std::uint16_t recognise(const Sight& sight, const Random& in_cell, const Random& in_frame) const;

  LabelNoiseConfig config_;
  std::vector<Class> classes_;  // sorted by id
  std::uint64_t seed_;
};

}  // namespace lapis::simulator
