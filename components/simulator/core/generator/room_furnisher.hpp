#pragma once

#include <optional>
#include <vector>

#include "simulator/core/generator/articles.hpp"
#include "simulator/core/generator/room_space.hpp"
#include "simulator/core/looks/dice.hpp"

namespace lapis::simulator {

/// An item in its room's frame.
struct PlacedItem {
  Article article;
  Eigen::Vector2d at{0, 0};       ///< middle of the footprint [m]; on another item: offset in that item's frame
  int yaw_deg = 0;                ///< 0: the front looks along -y
  std::optional<std::size_t> on;  ///< index of the item on which it stands
  bool is_movable = false;
  std::uint64_t variant = 0;
};

/// A picture on wall `edge`, `along_m` from that wall's first corner.
struct HungPicture {
  const char* class_name = "picture";
  std::size_t edge = 0;
  double along_m = 0.0, height_m = 1.5;
  Eigen::Vector2d size_m{0.6, 0.45};
};

struct RoomContents {
  std::vector<PlacedItem> items;  ///< an item that stands on another one comes after it
  std::vector<HungPicture> pictures;
};

/// Puts items into one room, one after another, where there is space for them. The functions that add an item return
/// its index, or nothing when it does not fit.
class RoomFurnisher {
 public:
  RoomFurnisher(const PlannedRoom& room, std::vector<LocalOpening> openings, double height_m, Dice dice);

  Dice& dice() { return dice_; }
  double area_m2() const { return std::abs(signed_area(polygon_)); }
  double height_m() const { return height_m_; }
  const Polygon& polygon() const { return polygon_; }
  const std::vector<LocalOpening>& openings() const { return openings_; }
  Eigen::Vector2d place_of(const LocalOpening& opening) const;

  const Article& any(Stock stock);
  /// Adds an item with its back to a wall: at a random place or, failing that, anywhere along the walls.
  /// @param near_corner the random places are at the ends of walls
  std::optional<std::size_t> against_wall(const Article& article, bool near_corner = false);
  /// Adds an item on the right or left of one that stands against a wall, with its back to the same wall.
  std::optional<std::size_t> beside(std::size_t neighbour, const Article& article, bool on_the_right);
  /// Adds an item in front of another one, `gap_m` away, `aside_m` to the side, and looking at it.
  std::optional<std::size_t> before(std::size_t index, const Article& article, double gap_m, double aside_m = 0.0);
  /// Adds an item at a random place, at least `margin_m` from the outermost walls.
  std::optional<std::size_t> free_standing(const Article& article, double margin_m);
  std::optional<std::size_t> at(const Article& article, const Eigen::Vector2d& middle, int yaw_deg);
  std::size_t on(std::size_t support, const Article& article, const Eigen::Vector2d& offset, int yaw_deg = 0);
  void set_movable(std::size_t item) { contents_.items[item].is_movable = true; }
  const PlacedItem& item(std::size_t index) const { return contents_.items[index]; }

  /// Hangs pictures about `spacing_m` apart on all walls, each with this probability, where there is no door or window
  /// and nothing high stands in front of them.
  void hang_pictures(double spacing_m, double probability);
  /// Hangs large pictures or pin boards on this share of the bare stretches of wall, low enough that a camera at 1 m
  /// sees them from near.
  void hang_low(const char* class_name, double share);
  /// Hangs one thing (a board, a mirror) on the wall above an item.
  void hang_above(std::size_t index, const char* class_name, const Eigen::Vector2d& size_m, double height_m);

  RoomContents contents() && { return std::move(contents_); }

 private:
  struct Wall {
    Eigen::Vector2d start, direction, inward;
    double length_m;
  };

  Wall wall(std::size_t index) const;
  std::optional<std::size_t> at_wall(std::size_t index, double along_m, const Article& article);
  std::size_t add(const Article& article, const Eigen::Vector2d& at, int yaw_deg);
  bool has_room_for(const HungPicture& picture) const;

  Polygon polygon_;
  std::vector<LocalOpening> openings_;
  double height_m_;
  Dice dice_;
  RoomSpace space_;
  RoomContents contents_;
  std::vector<std::optional<std::pair<std::size_t, double>>> walls_of_;  ///< per item: its wall, and the place along it
};

}  // namespace lapis::simulator
