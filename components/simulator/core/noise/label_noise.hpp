#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/model/label_list.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {

enum class LabelModel { kNone, kDefault };

/// With the default 64 % of the pixels on the apartment's tour have their true class, and 0.25 m maps have an IoU of
/// 0.70 with their ideal in the 8 most frequent classes, 0.56 with 10 cm of pose error (lapis_label_noise_calibration).
struct LabelNoiseConfig {
  LabelModel model = LabelModel::kDefault;
  double accuracy = 0.75;          ///< of an ordinary class close by, 0 to 1
  double range_loss_per_m = 0.05;  ///< of accuracy, beyond free_range_m; >= 0
  double free_range_m = 1.5;       ///< >= 0
  double small_loss = 0.25;        ///< of accuracy of an instance with fewer than small_px pixels, 0 to 1
  int small_px = 160;              ///< >= 0
  double flip = 0.1;               ///< share of instances that one frame takes for something else, 0 to 1
  double warp_px = 4.0;            ///< standard deviation of the boundaries' displacement, 0 to 50
};

/// Turns true labels into what a segmentation network gives. Instances are taken for another class as a whole, and
/// for the same one as long as the camera stays within a metre and 45 degrees, so that errors do not average out;
/// boundaries wobble from frame to frame. Classes are known by their mpcat40 names: they are mostly taken for others
/// of their kind; a class of another name is taken for any.
class LabelNoise {
 public:
  /// @param list the classes that the network knows
  LabelNoise(const LabelNoiseConfig& config, const mapping::LabelList& list, std::uint64_t seed);

  /// @param labels class ids, one class per instance; @param instances 0: nothing there, stays unlabelled
  /// @param depth [m], of the same size; @param T_world_camera pose of the optical frame
  /// @throws std::invalid_argument when the sizes differ
  geometry::LabelImage apply(const geometry::LabelImage& labels, const geometry::Image<std::uint16_t>& instances,
                             const geometry::DepthImage& depth, const geometry::Pose& T_world_camera,
                             std::uint64_t tick) const;

  /// Probability that an instance is taken for what it is, without the flips of single frames.
  /// @param range_m mean depth; @param pixels in the image. 1 for unlabelled, and for classes that are not listed.
  double accuracy(std::uint16_t class_id, double range_m, int pixels) const;
  /// Probability that an instance that is not taken for what it is is taken for `other`.
  double confusion(std::uint16_t class_id, std::uint16_t other) const;

 private:
  struct Class {
    std::uint16_t id;
    unsigned groups;  // bit set
    double bonus;     // on accuracy
    double appeal;    // how often others are taken for it; 0: "unlabeled", which is nothing to be taken for
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
