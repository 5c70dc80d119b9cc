#pragma once

#include <cstdint>
#include <string>

#include "common/mapping/model/label_list.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/votes/compact_frame.hpp"
#include "common/mapping/votes/integration.hpp"

namespace lapis::mapping {

inline constexpr double kDefaultResolution_m = 0.25;

/// How a frame becomes votes.
struct FrameSettings {
  IntegrationConfig integration;
  int stride = CompactFrameConfig{}.stride;

  bool operator==(const FrameSettings&) const = default;
};

/// What has to be known of a map to read its counts, or to build another one that can be compared with it. It travels
/// with the map: in map files and on /semantic_mapper/map_description. The defaults are those of a mapper that nobody
/// configured.
struct MapDescription {
  double resolution_m = kDefaultResolution_m;  ///< edge of a voxel
  FrameSettings frames;
  SensorModel sensor_model;  ///< its class_count is that of the labels
  LabelList labels;
  std::int64_t epoch = 0;    ///< as MapState; 0: no map has begun yet
  std::int64_t session = 0;  ///< of slam, in whose map frame the map is

  bool operator==(const MapDescription&) const = default;
};

/// The sensor model for a list of classes: without a list its own number of them stays.
SensorModel with_classes(SensorModel model, const LabelList& labels);

/// Throws std::runtime_error naming the value that is out of range or not finite.
void validate(const FrameSettings& frames, double resolution_m);
void validate(const MapDescription& description);

/// The first setting in which two maps differ that were to be built alike, with both values: "min_range_m 0.2 and 0.3";
/// empty when there is none. The kernel of "bki" is left out: no reference has one.
std::string difference(const FrameSettings& a, const FrameSettings& b);
/// The same of all that does not change while a mapper runs: resolution, frames, sensor model but for its class_count.
std::string difference(const MapDescription& a, const MapDescription& b);

/// The settings of a reference for a map: its own, but for the kernel of "bki", whose effect a reference shows.
FrameSettings of_reference(FrameSettings frames);

}  // namespace lapis::mapping
