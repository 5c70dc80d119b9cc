#include "simulator/core/building/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/core/building/keep_clear.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

constexpr double kMaxMove_m = 0.05, kMaxTurn_rad = 10.0 * std::numbers::pi / 180.0;
constexpr double kMaxPictureMove_m = 0.1;
constexpr double kFlat_m = 0.03;           // lower items, such as rugs, are in nobody's way
constexpr double kOpeningMargin_m = 0.07;  // around doors and windows

/// Places items one after another; `OnItem` refers to earlier ones.
class FurniturePlacer {
 public:
  FurniturePlacer(const SceneSpec& spec, const std::vector<RoomPlan>& plan, const std::vector<ItemExtent>& extents)
      : spec_(spec), plan_(plan), extents_(extents) {
    for (std::size_t i = 0; i < spec.furniture.size(); ++i) poses_.push_back(pose(i));
  }

  void jitter(std::uint64_t seed) {
    const std::vector<Polygon> clear = keep_clear(spec_, plan_);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!spec_.furniture[i].is_movable) continue;
      const Random random(seed, RandomStream::kFurniture, i);
      for (const double share : {1.0, 0.5, 0.25}) {
        ItemPose moved = poses_[i];
        const double x = random.uniform(0, -1.0, 1.0), y = random.uniform(1, -1.0, 1.0);
        moved.at += share * kMaxMove_m * Eigen::Vector2d(x, y);
        moved.yaw_rad += share * kMaxTurn_rad * random.uniform(2, -1.0, 1.0);
        if (!is_free(i, moved, clear)) continue;
        poses_[i] = moved;
        break;
      }
      take_along(i);
    }
  }

  std::vector<ItemPose> poses() && { return std::move(poses_); }

 private:
  ItemPose pose(std::size_t i) const {
    const FurnitureSpec& item = spec_.furniture[i];
    ItemPose result;
    if (const auto* point = std::get_if<AtPoint>(&item.place)) {
      result = {point->at, point->yaw_rad, 0.0};
    } else if (const auto* against = std::get_if<AgainstWall>(&item.place)) {
      result = against_wall(*against, extents_[i]);
    } else {
      const auto& on = std::get<OnItem>(item.place);
      const std::size_t support = index_of(on.item);
      const ItemPose& below = poses_[support];
      result.at = below.at + Eigen::Rotation2Dd(below.yaw_rad) * on.offset;
      result.yaw_rad = below.yaw_rad + on.yaw_rad;
      result.bottom_m = below.bottom_m + extents_[support].size_m.z();
    }
    result.bottom_m += extents_[i].elevation_m;
    return result;
  }

  ItemPose against_wall(const AgainstWall& place, const ItemExtent& extent) const {
    const Wall& wall = plan_[room_index(spec_, place.room)].walls[static_cast<std::size_t>(place.edge)];
    const double c = std::abs(std::cos(place.turn_rad)), s = std::abs(std::sin(place.turn_rad));
    const double half_depth = 0.5 * (c * extent.size_m.y() + s * extent.size_m.x());
    // At yaw 0 the front looks along -y; here it looks along the wall's inward normal.
    const double heading = std::atan2(wall.inward.y(), wall.inward.x()) + 0.5 * std::numbers::pi;
    return {wall.at(place.along_m, place.gap_m + half_depth), heading + place.turn_rad, 0.0};
  }

  std::size_t index_of(const std::string& id) const {
    const auto has_id = [&](const FurnitureSpec& item) { return item.id == id; };
    const auto it = std::find_if(spec_.furniture.begin(), spec_.furniture.end(), has_id);
    return static_cast<std::size_t>(it - spec_.furniture.begin());
  }

  bool stands_on(std::size_t upper, std::size_t lower) const {
    const auto* on = std::get_if<OnItem>(&spec_.furniture[upper].place);
    return on && on->item == spec_.furniture[lower].id;
  }

  bool meets(std::size_t i, const ItemPose& a, std::size_t k) const {
    const ItemPose& b = poses_[k];
    const double height_a = extents_[i].size_m.z(), height_b = extents_[k].size_m.z();
    if (std::min(height_a, height_b) < kFlat_m) return false;
    if (a.bottom_m >= b.bottom_m + height_b || b.bottom_m >= a.bottom_m + height_a) return false;
    return overlap(a.footprint(extents_[i]), b.footprint(extents_[k]));
  }

  /// Moves the items that stand on an item, those that stand on them, and so on. They come later in the list, and have
  /// not been moved by themselves yet.
  void take_along(std::size_t moved) {
    for (std::size_t i = moved + 1; i < poses_.size(); ++i) {
      if (std::holds_alternative<OnItem>(spec_.furniture[i].place)) poses_[i] = pose(i);
    }
  }

  bool is_free(std::size_t i, const ItemPose& moved, const std::vector<Polygon>& clear) const {
    const Polygon footprint = moved.footprint(extents_[i]);
    const auto meets_zone = [&](const Polygon& zone) { return overlap(footprint, zone); };
    if (const auto* on = std::get_if<OnItem>(&spec_.furniture[i].place)) {
      const std::size_t support = index_of(on->item);
      if (!contains(poses_[support].footprint(extents_[support]), footprint)) return false;
    } else if (std::none_of(spec_.rooms.begin(), spec_.rooms.end(),
                            [&](const RoomSpec& room) { return contains(room.polygon, footprint); }) ||
               std::any_of(clear.begin(), clear.end(), meets_zone)) {
      return false;
    }
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      if (k != i && !stands_on(i, k) && !stands_on(k, i) && meets(i, moved, k)) return false;
    }
    return true;
  }

  const SceneSpec& spec_;
  const std::vector<RoomPlan>& plan_;
  const std::vector<ItemExtent>& extents_;
  std::vector<ItemPose> poses_;
};

/// Names what is in the way of a picture at a place along its wall; "" when nothing is.
std::string obstacle(const SceneSpec& spec, const std::vector<RoomPlan>& plan, const std::vector<double>& places,
                     std::size_t index, double along_m) {
  const PictureSpec& picture = spec.pictures[index];
  const RoomPlan& room = plan[room_index(spec, picture.room)];
  const Wall& wall = room.walls[static_cast<std::size_t>(picture.edge)];
  const Eigen::Vector2d half = 0.5 * picture.size_m;
  const Eigen::AlignedBox2d box(Eigen::Vector2d(along_m - half.x(), picture.height_m - half.y()),
                                Eigen::Vector2d(along_m + half.x(), picture.height_m + half.y()));
  const Eigen::AlignedBox2d face(Eigen::Vector2d(0, 0), Eigen::Vector2d(wall.length_m, room.height_m));
  if (!face.contains(box)) return "leaves its wall";
  const Eigen::Vector2d margin(kOpeningMargin_m, kOpeningMargin_m);
  for (const WallOpening& hole : wall.openings) {
    const Eigen::AlignedBox2d frame(Eigen::Vector2d(hole.from_m, hole.bottom_m) - margin,
                                    Eigen::Vector2d(hole.to_m, hole.top_m) + margin);
    if (frame.intersection(box).sizes().minCoeff() > 0.0) return "meets " + numbered("opening", hole.opening);
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const PictureSpec& other = spec.pictures[k];
    if (k == index || other.room != picture.room || other.edge != picture.edge) continue;
    const Eigen::Vector2d distance(places[k] - along_m, other.height_m - picture.height_m);
    const Eigen::Vector2d needed = half + 0.5 * other.size_m;
    if ((distance.cwiseAbs() - needed).maxCoeff() < 0.0) return "meets " + numbered("picture", k);
  }
  return {};
}

}  // namespace

Eigen::Affine3f ItemPose::T_world_item() const {
  const Eigen::Vector3f foot(static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(bottom_m));
  return Eigen::Translation3f(foot) * Eigen::AngleAxisf(static_cast<float>(yaw_rad), Eigen::Vector3f::UnitZ());
}

std::vector<ItemPose> place_furniture(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                      const std::vector<ItemExtent>& extents) {
  return FurniturePlacer(spec, plan, extents).poses();
}

std::vector<ItemPose> place_furniture_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                                  const std::vector<ItemExtent>& extents, std::uint64_t seed) {
  FurniturePlacer placer(spec, plan, extents);
  placer.jitter(seed);
  return std::move(placer).poses();
}

std::vector<double> place_pictures(const SceneSpec& spec, const std::vector<RoomPlan>& plan) {
  std::vector<double> places;
  for (const PictureSpec& picture : spec.pictures) places.push_back(picture.along_m);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string what = obstacle(spec, plan, places, i, places[i]);
    if (!what.empty()) refuse(spec, numbered("picture", i), what);
  }
  return places;
}

std::vector<double> place_pictures_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                               std::uint64_t seed) {
  std::vector<double> places = place_pictures(spec, plan);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto has_its_motif = [&](const PictureSpec& other) { return other.motif == spec.pictures[i].motif; };
    // Pictures with the same motif are in copies of a room, which have to stay alike.
    if (std::count_if(spec.pictures.begin(), spec.pictures.end(), has_its_motif) > 1) continue;
    const Random random(seed, RandomStream::kPictures, i);
    const double move = random.uniform(0, -kMaxPictureMove_m, kMaxPictureMove_m);
    for (const double share : {1.0, 0.5, 0.25}) {
      if (!obstacle(spec, plan, places, i, places[i] + share * move).empty()) continue;
      places[i] += share * move;
      break;
    }
  }
  return places;
}

std::size_t room_index(const SceneSpec& spec, const std::string& id) {
  const auto it =
      std::find_if(spec.rooms.begin(), spec.rooms.end(), [&](const RoomSpec& room) { return room.id == id; });
  return static_cast<std::size_t>(it - spec.rooms.begin());
}

}  // namespace lapis::simulator
