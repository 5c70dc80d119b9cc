#pragma once

#include <cstdint>
#include <string>

#include "common/mapping/model/label_list.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/votes/compact_frame.hpp"
#include "common/mapping/votes/integration.hpp"

namespace lapis::mapping {

inline constexpr double kDefaultResolution_m = 0.25;

/// The settings with which a frame becomes votes.
struct FrameSettings {
  IntegrationConfig integration;
  int stride = CompactFrameConfig{}.stride;

  bool operator==(const FrameSettings&) const = default;
};

/// What is needed to read a map's counts, or to build another map that can be compared with it. It accompanies the map
/// in map files and on /semantic_mapper/map_description. The defaults are those of a mapper without configuration.
struct MapDescription {
  double resolution_m = kDefaultResolution_m;  ///< edge of a voxel
  FrameSettings frames;
  SensorModel sensor_model;  ///< its class_count is that of the labels
  LabelList labels;
  std::int64_t epoch = 0;    ///< as in MapState; 0: no map has been started yet
  std::int64_t session = 0;  ///< session of slam, whose map frame the map uses

  bool operator==(const MapDescription&) const = default;
};

/// The sensor model for a list of classes: class_count becomes the largest id, unless the list has no id above 1.
SensorModel with_classes(SensorModel model, const LabelList& labels);

/// Throws std::runtime_error naming the value that is out of range or not finite.
void validate(const FrameSettings& frames, double resolution_m);
void validate(const MapDescription& description);

/// The first setting that differs between two maps that should be built in the same way, with both values: "min_range_m
/// 0.2 and 0.3"; empty when there is none. The kernel of "bki" is not compared, because references have no kernel.
std::string difference(const FrameSettings& a, const FrameSettings& b);
/// The same for everything that does not change while a mapper runs: resolution, frame settings, and the sensor model
/// without class_count and class_priors.
std::string difference(const MapDescription& a, const MapDescription& b);

/// The settings with which the reference of a map is built: those of the map without the kernel of "bki", so that a
/// comparison with the reference shows the effect of the kernel.
FrameSettings of_reference(FrameSettings frames);

}  // namespace lapis::mapping
