#pragma once

#include "common/dds/participant.hpp"

namespace lapis::test {

/// What the publishing side sends.
struct Load {
  double images_hz = 15.0;
  int image_bytes = 691'200;  ///< 640 x 360 rgb8
  int images = 300;
  int tiles = 100;
  int tile_bytes = 100'000;
  int tiles_after = 30;      ///< number of images before all tiles are written at once
  double patience_s = 15.0;  ///< how long to wait at the end until everything has been acknowledged
};

/// Waits for the subscribing side, sends the load and prints what it cost as one line of JSON.
int publish(const dds::ParticipantOptions& options, const Load& load);

/// Receives until SIGTERM or SIGINT and prints what came as one line of JSON.
int subscribe(const dds::ParticipantOptions& options);

}  // namespace lapis::test
