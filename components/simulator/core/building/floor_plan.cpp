#include "simulator/core/building/floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kReach_m = 0.5;  // greatest distance of an opening from its wall, and between the walls of two rooms

Wall wall_of(const std::vector<Eigen::Vector2d>& polygon, std::size_t edge) {
  Wall wall;
  wall.start = polygon[edge];
  const Eigen::Vector2d span = polygon[(edge + 1) % polygon.size()] - wall.start;
  wall.length_m = span.norm();
  wall.direction = span / wall.length_m;
  wall.inward = Eigen::Vector2d(-wall.direction.y(), wall.direction.x());
  return wall;
}

struct WallRef {
  std::size_t room = 0, wall = 0;
};

/// Finds the walls that carry an opening and cuts it into them.
class OpeningCutter {
 public:
  OpeningCutter(const SceneSpec& spec, std::vector<RoomPlan>& plan) : spec_(spec), plan_(plan) {}

  void cut(std::size_t opening) {
    const OpeningSpec& wanted = spec_.openings[opening];
    const WallRef front = nearest_wall(opening);
    const std::optional<WallRef> back = wall_behind(front, wanted);
    if (!back && (wanted.kind == OpeningKind::kDoor || wanted.kind == OpeningKind::kPassage)) {
      refuse(spec_, name(opening), "leads outside; use a leaf (a closed door) or a window");
    }
    const double depth = back ? 0.5 * std::max(0.0, gap(wall(front), wall(*back))) : spec_.wall_thickness_m;
    cut_into(front, opening, depth);
    if (back) cut_into(*back, opening, depth);
  }

 private:
  static std::string name(std::size_t opening) { return numbered("opening", opening); }
  Wall& wall(const WallRef& ref) { return plan_[ref.room].walls[ref.wall]; }
  const Wall& wall(const WallRef& ref) const { return plan_[ref.room].walls[ref.wall]; }

  /// Distance of `back` behind `front` [m].
  static double gap(const Wall& front, const Wall& back) { return -(back.start - front.start).dot(front.inward); }

  template <class Function>
  void for_all_walls(const Function& function) const {
    for (std::size_t room = 0; room < plan_.size(); ++room) {
      for (std::size_t i = 0; i < plan_[room].walls.size(); ++i) function(WallRef{room, i});
    }
  }

  WallRef nearest_wall(std::size_t opening) const {
    WallRef nearest;
    double best = std::numeric_limits<double>::infinity();
    for_all_walls([&](const WallRef& ref) {
      const Wall& candidate = wall(ref);
      const Eigen::Vector2d offset = spec_.openings[opening].at - candidate.start;
      const double along = std::clamp(offset.dot(candidate.direction), 0.0, candidate.length_m);
      const double distance = (offset - along * candidate.direction).norm();
      if (distance >= best) return;
      best = distance;
      nearest = ref;
    });
    if (best > kReach_m) refuse(spec_, name(opening), "no wall within 0.5 m carries it");
    return nearest;
  }

  /// The wall behind `front` that faces the other way, with the least sum of distance and uncovered opening width.
  std::optional<WallRef> wall_behind(const WallRef& front, const OpeningSpec& opening) const {
    std::optional<WallRef> nearest;
    double best = std::numeric_limits<double>::infinity();
    for_all_walls([&](const WallRef& ref) {
      const Wall& candidate = wall(ref);
      if (candidate.inward.dot(wall(front).inward) > -0.999) return;
      const double distance = gap(wall(front), candidate), half = 0.5 * opening.width_m;
      const double along = (opening.at - candidate.start).dot(candidate.direction);
      // Distance from either end of the wall to the opening's farther end.
      const double left = along + half, right = candidate.length_m - along + half;
      if (distance < -1e-3 || distance > kReach_m || left < 0.0 || right < 0.0) return;
      const double uncovered = std::max({0.0, opening.width_m - left, opening.width_m - right});
      if (distance + uncovered >= best) return;
      best = distance + uncovered;
      nearest = ref;
    });
    return nearest;
  }

  void cut_into(const WallRef& ref, std::size_t opening, double depth_m) {
    const OpeningSpec& wanted = spec_.openings[opening];
    Wall& carrier = wall(ref);
    const double along = (wanted.at - carrier.start).dot(carrier.direction), half = 0.5 * wanted.width_m;
    const std::string where = "wall " + std::to_string(ref.wall) + " of room \"" + spec_.rooms[ref.room].id + "\"";
    if (wanted.width_m > carrier.length_m) refuse(spec_, name(opening), "is wider than " + where);
    if (along - half < -1e-3 || along + half > carrier.length_m + 1e-3) refuse(spec_, name(opening), "leaves " + where);
    if (wanted.top_m > plan_[ref.room].height_m) refuse(spec_, name(opening), "is higher than " + where);
    for (const WallOpening& other : carrier.openings) {
      const bool meets = along - half < other.to_m && along + half > other.from_m && wanted.bottom_m < other.top_m &&
                         wanted.top_m > other.bottom_m;
      if (meets) refuse(spec_, name(opening), "meets " + name(other.opening) + " in " + where);
    }
    carrier.openings.push_back({along - half, along + half, wanted.bottom_m, wanted.top_m, depth_m, opening});
  }

  const SceneSpec& spec_;
  std::vector<RoomPlan>& plan_;
};

}  // namespace

Eigen::Affine3f Wall::T_world_wall() const {
  Eigen::Affine3f T = Eigen::Affine3f::Identity();
  T.linear().topLeftCorner<2, 1>() = direction.cast<float>();
  T.linear().block<2, 1>(0, 1) = inward.cast<float>();
  T.translation().head<2>() = start.cast<float>();
  return T;
}

std::vector<RoomPlan> plan_walls(const SceneSpec& spec) {
  std::vector<RoomPlan> plan;
  for (const RoomSpec& room : spec.rooms) {
    RoomPlan& added = plan.emplace_back();
    added.height_m = room.height_m.value_or(spec.height_m);
    for (std::size_t i = 0; i < room.polygon.size(); ++i) added.walls.push_back(wall_of(room.polygon, i));
  }
  OpeningCutter cutter(spec, plan);
  for (std::size_t i = 0; i < spec.openings.size(); ++i) cutter.cut(i);
  for (RoomPlan& room : plan) {
    for (Wall& wall : room.walls) {
      std::sort(wall.openings.begin(), wall.openings.end(),
                [](const WallOpening& a, const WallOpening& b) { return a.from_m < b.from_m; });
    }
  }
  return plan;
}

void refuse(const SceneSpec& spec, const std::string& item, const std::string& what) {
  throw std::runtime_error(spec.file + ": " + item + ": " + what);
}

std::string numbered(const std::string& what, std::size_t index) { return what + " " + std::to_string(index + 1); }

}  // namespace lapis::simulator
