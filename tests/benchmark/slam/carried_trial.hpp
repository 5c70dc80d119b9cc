#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "simulator/core/robot/tour.hpp"
#include "simulator/core/simulation.hpp"
#include "tests/benchmark/slam/watched_slam.hpp"

namespace lapis::slam::benchmark {

/// A robot that is lifted on its tour, and set down at another place.
struct CarriedTrial {
  std::vector<WatchedFrame> frames;
  WatchedMap map;
  simulator::StartPose place;  ///< where it was set down, in the world
  double carried_m = 0.0;      ///< how far
  std::size_t lifted = 0;      ///< first frame in the air
  std::size_t set_down = 0;    ///< first frame on the floor again
};

/// What a tour is driven with.
struct TourSetting {
  const simulator::World& world;
  simulator::SimulationConfig simulation;
  simulator::TourConfig tour;
  simulator::StartPose start;
  double longest_s = 0.0;  ///< it is cut there; 0: nowhere
};

/// When the robot is lifted, and where to.
struct Carry {
  bool with_odometry = true;
  bool to_new_place = false;            ///< it has not been near; else it has been there, or beside
  double earliest = 0.5, latest = 1.0;  ///< share of the tour after which it is lifted
  double in_air_s = 2.0;
  double search_s = 120.0, after_s = 30.0;  ///< longest drive afterwards, and drive from where it is found on
  bool again = false;                       ///< the tour afterwards is driven again and again until then
  double wrong_s = std::numeric_limits<double>::infinity();  ///< it ends after so long with wrong poses once lost
};

/// Drives a tour through all rooms, on which the robot is lifted; meanwhile the camera sees nothing and the wheels
/// stand still. Then a tour through all rooms again, until it has been found for long.
/// @throws std::runtime_error with one line that says why the trial cannot be driven
CarriedTrial drive_carried(const TourSetting& setting, const SlamConfig& config, const Carry& carry = {});

struct CarriedVerdict {
  bool is_found = false;
  double found_s = std::numeric_limits<double>::infinity();     ///< after the set-down
  double found_m = std::numeric_limits<double>::infinity();     ///< path driven until then
  double declared_s = std::numeric_limits<double>::infinity();  ///< from the set-down to the first frame that is lost
  PoseError before;                                             ///< of the last pose before it was lifted
  // Time for which poses off by more than 1 m were published after the set-down, by source:
  double wrong_vision_s = 0.0, wrong_surfaces_s = 0.0, wrong_odometry_s = 0.0;
  double wrong_return_s = 0.0;  ///< ... by vision or surfaces once it had been lost: a place that it is not at
  bool is_wrong = false;        ///< by more than 2 s of that, or by a loop in the map at the end
};

/// Found: vision or surfaces give a pose within 0.3 m and 10 degrees of the truth, and for 2 s from there every frame
/// has one.
CarriedVerdict judge(const CarriedTrial& trial);

/// Of a robot that was carried to a new place without odometry.
struct ElsewhereVerdict {
  bool has_begun = false;                                     ///< mapping has gone on in a sub-map
  double begun_s = std::numeric_limits<double>::infinity();   ///< after the set-down
  double joined_s = std::numeric_limits<double>::infinity();  ///< first frame with a pose in the map
  double joined_m = std::numeric_limits<double>::infinity();  ///< path driven until then
  double known_m = 0.0;                                       ///< ... of which where it had been before it was lifted
  double seen_m = 0.0;  ///< extent of the places at which, until then or the end, it saw what it had seen before
  PoseError joined;     ///< of the first pose
  double tracked_ms = 0.0, lost_ms = 0.0;  ///< median CPU of a frame: tracked, no key-frame; lost, not covered
  bool is_found = false;
  bool is_wrong = false;  ///< it was joined at a wrong place, or the map has a wrong loop or misplaced key-frames
};

ElsewhereVerdict judge_elsewhere(const CarriedTrial& trial);

}  // namespace lapis::slam::benchmark
