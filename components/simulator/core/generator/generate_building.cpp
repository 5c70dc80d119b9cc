#include "simulator/core/generator/generate_building.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/core/generator/floor_drawing.hpp"
#include "simulator/core/generator/furnish.hpp"
#include "simulator/core/generator/layout.hpp"
#include "simulator/core/generator/round_trip.hpp"

namespace lapis::simulator {
namespace {

constexpr double kHallLampSpacing_m = 5.5, kLampMargin_m = 0.3;

/// A point rounded to whole centimetres, without negative zeros.
Eigen::Vector2d rounded(const Eigen::Vector2d& p) { return {cm(p.x()) + 0.0, cm(p.y()) + 0.0}; }

class BuildingGenerator {
 public:
  BuildingGenerator(const BuildingName& name, const mapping::LabelList& labels) : name_(name), plan_(lay_out(name)) {
    spec_.name = to_string(name);
    spec_.file = spec_.name;
    spec_.labels = labels;
    spec_.height_m = plan_.height_m;
    spec_.wall_thickness_m = plan_.wall_m;
    spec_.is_stress = plan_.is_plain;
  }

  SceneSpec generate() && {
    for (const PlannedRoom& room : plan_.rooms) add_room(room);
    for (OpeningSpec opening : plan_.openings) {
      opening.at = rounded(opening.at);
      spec_.openings.push_back(opening);
    }
    for (std::size_t i = 0; i < plan_.rooms.size(); ++i) add_contents(i);
    if (name_.kind == BuildingKind::kWarehouse) add_lamps();
    const RoundTrip trip = plan_round_trip(spec_, Random(name_.seed, RandomStream::kBuilding, 200));
    spec_.starts = trip.starts;
    spec_.tour = trip.waypoints;
    return std::move(spec_);
  }

 private:
  double height_of(const PlannedRoom& room) const { return room.height_m.value_or(plan_.height_m); }

  void add_room(const PlannedRoom& room) {
    RoomSpec& added = spec_.rooms.emplace_back();
    added.id = room.id;
    added.type = room.id.substr(0, room.id.find_last_of('_'));
    for (const auto& corner : room.polygon) added.polygon.push_back(rounded(room.frame.at(corner)));
    added.floor = room.floor;
    added.wall = room.wall;
    added.ceiling = room.ceiling;
    added.height_m = room.height_m;
  }

  bool has_copies(std::size_t index) const {
    return plan_.rooms[index].copy_of || std::any_of(plan_.rooms.begin(), plan_.rooms.end(),
                                                     [&](const PlannedRoom& r) { return r.copy_of == index; });
  }

  void add_contents(std::size_t index) {
    const PlannedRoom& room = plan_.rooms[index];
    if (room.copy_of) {
      contents_.push_back(contents_[*room.copy_of]);
    } else {
      const Dice dice(Random(name_.seed, RandomStream::kBuilding, 1000 + index));
      contents_.push_back(
          furnish(room, openings_of(plan_, room), height_of(room), {plan_.is_plain, name_.has_panes}, dice));
    }
    const std::size_t motifs = index_of_motif(index);
    const RoomContents& contents = contents_.back();
    for (std::size_t i = 0; i < contents.items.size(); ++i) add_item(room, contents.items[i], i, has_copies(index));
    for (std::size_t i = 0; i < contents.pictures.size(); ++i) {
      const HungPicture& hung = contents.pictures[i];
      PictureSpec picture;
      picture.class_name = hung.class_name;
      picture.room = room.id;
      picture.edge = static_cast<int>(hung.edge);
      picture.along_m = hung.along_m;
      picture.height_m = hung.height_m;
      picture.size_m = hung.size_m;
      picture.motif = motifs + i;
      spec_.pictures.push_back(picture);
    }
  }

  /// Number of the first motif of a room: copies of a room share it, other rooms have numbers of their own.
  std::size_t index_of_motif(std::size_t room) {
    if (plan_.rooms[room].copy_of) {
      first_motifs_.push_back(first_motifs_[*plan_.rooms[room].copy_of]);
    } else {
      first_motifs_.push_back(next_motif_);
      next_motif_ += contents_.back().pictures.size();
    }
    return first_motifs_.back();
  }

  void add_item(const PlannedRoom& room, const PlacedItem& placed, std::size_t index, bool is_fixed) {
    const Article& article = placed.article;
    FurnitureSpec item;
    item.id = item_id(room, index);
    item.class_name = article.class_name;
    if (article.model != nullptr) item.model = article.model;
    item.size_m = Eigen::Vector3d(article.width_m, article.depth_m, cm(article.height_m));
    item.elevation_m = 0.0;
    item.is_movable = placed.is_movable && !is_fixed;
    item.variant = placed.variant;
    const double yaw_rad = placed.yaw_deg * std::numbers::pi / 180.0;
    if (placed.on) {
      const double side = room.frame.is_mirrored() ? -1.0 : 1.0;
      item.place = OnItem{item_id(room, *placed.on), {side * placed.at.x() + 0.0, placed.at.y()}, side * yaw_rad + 0.0};
    } else {
      const double degrees = std::round(room.frame.yaw_rad(yaw_rad) * 180.0 / std::numbers::pi) + 0.0;
      item.place = AtPoint{rounded(room.frame.at(placed.at)), degrees * std::numbers::pi / 180.0};
    }
    spec_.furniture.push_back(item);
  }

  static std::string item_id(const PlannedRoom& room, std::size_t index) {
    return room.id + "." + std::to_string(index + 1);
  }

  /// Adds the lamps of a warehouse: high halls need fewer than one per 12 m2.
  void add_lamps() {
    for (const PlannedRoom& room : plan_.rooms) {
      Eigen::AlignedBox2d box;
      for (const auto& corner : room.polygon) box.extend(corner);
      const auto count = [](double length) {
        return std::max(1, static_cast<int>(std::lround(length / kHallLampSpacing_m)));
      };
      const int columns = count(box.sizes().x()), rows = count(box.sizes().y());
      for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
          const Eigen::Vector2d share((column + 0.5) / columns, (row + 0.5) / rows);
          const Eigen::Vector2d local = box.min() + share.cwiseProduct(box.sizes());
          if (!contains(room.polygon, local) || distance_to_border(room.polygon, local) < kLampMargin_m) continue;
          spec_.lamps.push_back({rounded(room.frame.at(local)), {}, room.use == RoomUse::kHall ? 3.0 : 1.0});
        }
      }
    }
  }

  const BuildingName name_;
  const BuildingPlan plan_;
  SceneSpec spec_;
  std::vector<RoomContents> contents_;
  std::vector<std::size_t> first_motifs_;
  std::size_t next_motif_ = 0;
};

}  // namespace

SceneSpec generate_building(const BuildingName& name, const mapping::LabelList& labels) {
  return BuildingGenerator(name, labels).generate();
}

}  // namespace lapis::simulator
