#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/images/depth_registration.hpp"
#include "slam/core/calibration/depth_alignment.hpp"

namespace lapis::slam {

/// Compares depth with colour in the first seconds: do jumps of depth lie where grey values have contrast?
class DepthCalibrator {
 public:
  /// `fewest_views`: before anything is concluded [1, 16]. With 1, the first view may show a wrong calibration, and the
  /// next ones make the correction better.
  explicit DepthCalibrator(std::size_t fewest_views) : fewest_views_(fewest_views) {}

  /// Whether a frame of this time is wanted: views are some time apart, until enough has been seen.
  bool wants(time::Time stamp) const;
  bool is_over() const;
  /// Views by which the calibration in use has been judged.
  std::size_t views() const { return views_.size(); }
  /// Takes a frame, whose depth was registered by `used`, into account. An alignment that moves depth notably ends what
  /// the views have shown: later ones have to be of depth that is corrected by it.
  std::optional<DepthAlignment> add(const RgbdFrame& frame, const images::RgbdCalibration& used);

 private:
  std::size_t fewest_views_;
  std::vector<EdgeView> views_;                  // with edges
  std::optional<images::RgbdCalibration> used_;  // for all of them
  std::optional<time::Time> newest_;
  int seen_ = 0;  // views, also those without edges
  int found_ = 0;
};

/// The calibration that puts depth where `offset` says, from the one that it was registered by.
images::RgbdCalibration corrected(const images::RgbdCalibration& used, const DepthOffset& offset);
/// The offset by which `used` is corrected to `other`, which differs from it by such an offset.
DepthOffset offset_to(const images::RgbdCalibration& used, const images::RgbdCalibration& other);

/// The depth camera in words: focal length, and where it is beside that of colour.
std::string describe(const images::RgbdCalibration& cameras);

}  // namespace lapis::slam
