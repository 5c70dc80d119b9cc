#include "simulator/core/generator/room_furnisher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulator/core/generator/floor_drawing.hpp"

namespace lapis::simulator {
namespace {

constexpr int kTries = 12;
constexpr double kStep_m = 0.15;  // along the walls, when no random place was free
constexpr double kWallGap_m = 0.02, kBeside_m = 0.04;
constexpr double kPictureMargin_m = 0.15;
constexpr double kLowest_m = 0.15;  // an item that leaves less below the ceiling does not fit

Eigen::AlignedBox2d area_of(const Article& article, const Eigen::Vector2d& at, int yaw_deg) {
  const bool is_turned = std::abs(yaw_deg) % 180 == 90;
  const Eigen::Vector2d half = 0.5 * (is_turned ? Eigen::Vector2d(article.depth_m, article.width_m)
                                                : Eigen::Vector2d(article.width_m, article.depth_m));
  return {at - half, at + half};
}

/// Direction in which the front looks, for yaws that are multiples of 90 degrees.
Eigen::Vector2d front_of(int yaw_deg) {
  const double yaw = yaw_deg * std::numbers::pi / 180.0;
  return {std::round(std::sin(yaw)), -std::round(std::cos(yaw))};
}

}  // namespace

RoomFurnisher::RoomFurnisher(const PlannedRoom& room, std::vector<LocalOpening> openings, double height_m, Dice dice)
    : polygon_(room.polygon), openings_(std::move(openings)), height_m_(height_m), dice_(dice),
      space_(polygon_, openings_) {}

const Article& RoomFurnisher::any(Stock stock) {
  const auto choice = articles(stock);
  return choice[static_cast<std::size_t>(dice_.whole(0, static_cast<int>(choice.size()) - 1))];
}

RoomFurnisher::Wall RoomFurnisher::wall(std::size_t index) const {
  const Eigen::Vector2d& start = polygon_[index];
  const Eigen::Vector2d span = polygon_[(index + 1) % polygon_.size()] - start, direction = span.normalized();
  return {start, direction, {-direction.y(), direction.x()}, span.norm()};
}

Eigen::Vector2d RoomFurnisher::place_of(const LocalOpening& opening) const {
  const Wall w = wall(opening.wall);
  return w.start + opening.along_m * w.direction;
}

std::optional<std::size_t> RoomFurnisher::at(const Article& article, const Eigen::Vector2d& middle, int yaw_deg) {
  if (article.height_m > height_m_ - kLowest_m) return std::nullopt;
  const Eigen::Vector2d where(cm(middle.x()), cm(middle.y()));
  if (!space_.add({area_of(article, where, yaw_deg), 0.0, article.height_m})) return std::nullopt;
  return add(article, where, yaw_deg);
}

std::size_t RoomFurnisher::add(const Article& article, const Eigen::Vector2d& at, int yaw_deg) {
  PlacedItem item;
  item.article = article;
  item.at = at;
  item.yaw_deg = yaw_deg;
  item.variant = static_cast<std::uint64_t>(dice_.whole(0, 999));
  contents_.items.push_back(item);
  walls_of_.emplace_back();
  return contents_.items.size() - 1;
}

std::optional<std::size_t> RoomFurnisher::at_wall(std::size_t index, double along_m, const Article& article) {
  const Wall w = wall(index);
  if (along_m < 0.5 * article.width_m + kWallGap_m || along_m > w.length_m - 0.5 * article.width_m - kWallGap_m)
    return std::nullopt;
  // At yaw 0 the front looks along -y; here it looks into the room.
  const double heading = std::atan2(w.inward.y(), w.inward.x()) * 180.0 / std::numbers::pi + 90.0;
  const int yaw_deg = static_cast<int>(std::lround(heading)) % 360;
  const auto added =
      at(article, w.start + along_m * w.direction + (kWallGap_m + 0.5 * article.depth_m) * w.inward, yaw_deg);
  if (added) walls_of_[*added] = {index, along_m};
  return added;
}

std::optional<std::size_t> RoomFurnisher::against_wall(const Article& article, bool near_corner) {
  for (int i = 0; i < kTries; ++i) {
    const auto index = static_cast<std::size_t>(dice_.whole(0, static_cast<int>(polygon_.size()) - 1));
    const double half = 0.5 * article.width_m + 0.03, length = wall(index).length_m;
    double along = dice_(half, std::max(half, length - half));
    if (near_corner) along = dice_.chance(0.5) ? half : length - half;
    if (const auto added = at_wall(index, cm(along), article)) return added;
  }
  const int first = dice_.whole(0, static_cast<int>(polygon_.size()) - 1);
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    const std::size_t index = (static_cast<std::size_t>(first) + i) % polygon_.size();
    for (double along = 0.5 * article.width_m + 0.03; along < wall(index).length_m; along += kStep_m) {
      if (const auto added = at_wall(index, cm(along), article)) return added;
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> RoomFurnisher::beside(std::size_t neighbour, const Article& article, bool on_the_right) {
  if (!walls_of_[neighbour]) return std::nullopt;
  const auto [index, along] = *walls_of_[neighbour];
  const double step = 0.5 * (item(neighbour).article.width_m + article.width_m) + kBeside_m;
  return at_wall(index, cm(along + (on_the_right ? step : -step)), article);
}

std::optional<std::size_t> RoomFurnisher::before(std::size_t index, const Article& article, double gap_m,
                                                 double aside_m) {
  const PlacedItem& other = item(index);
  const Eigen::Vector2d front = front_of(other.yaw_deg), right(-front.y(), front.x());
  const double distance = 0.5 * (other.article.depth_m + article.depth_m) + gap_m;
  return at(article, other.at + distance * front + aside_m * right, (other.yaw_deg + 180) % 360);
}

std::optional<std::size_t> RoomFurnisher::free_standing(const Article& article, double margin_m) {
  Eigen::AlignedBox2d bounds;
  for (const auto& corner : polygon_) bounds.extend(corner);
  for (int i = 0; i < kTries; ++i) {
    const int yaw_deg = 90 * dice_.whole(0, 3);
    const Eigen::Vector2d half = 0.5 * area_of(article, {0, 0}, yaw_deg).sizes() + Eigen::Vector2d(margin_m, margin_m);
    const Eigen::Vector2d low = bounds.min() + half, high = bounds.max() - half;
    if ((high - low).minCoeff() < 0.0) continue;
    const double x = dice_(low.x(), high.x()), y = dice_(low.y(), high.y());
    if (const auto added = at(article, {x, y}, yaw_deg)) return added;
  }
  return std::nullopt;
}

std::size_t RoomFurnisher::on(std::size_t support, const Article& article, const Eigen::Vector2d& offset, int yaw_deg) {
  const std::size_t added = add(article, {cm(offset.x()), cm(offset.y())}, yaw_deg);
  contents_.items[added].on = support;
  return added;
}

bool RoomFurnisher::has_room_for(const HungPicture& picture) const {
  const double half = 0.5 * picture.size_m.x() + kPictureMargin_m;
  const Wall w = wall(picture.edge);
  if (picture.along_m < half || picture.along_m > w.length_m - half) return false;
  if (picture.height_m + 0.5 * picture.size_m.y() > height_m_ - kLowest_m) return false;
  for (const LocalOpening& opening : openings_) {
    if (opening.wall == picture.edge && std::abs(opening.along_m - picture.along_m) < half + 0.5 * opening.width_m)
      return false;
  }
  for (const HungPicture& other : contents_.pictures) {
    if (other.edge == picture.edge && std::abs(other.along_m - picture.along_m) < half + 0.5 * other.size_m.x())
      return false;
  }
  const double bottom = picture.height_m - 0.5 * picture.size_m.y() - 0.05;
  return std::none_of(contents_.items.begin(), contents_.items.end(), [&](const PlacedItem& item) {
    if (item.on || item.article.height_m < bottom) return false;
    const Eigen::AlignedBox2d area = area_of(item.article, item.at, item.yaw_deg);
    const Eigen::Vector2d center = w.start + picture.along_m * w.direction;
    Eigen::AlignedBox2d before(center - half * w.direction);
    before.extend(center + half * w.direction + 0.12 * w.inward);
    return area.intersects(before);
  });
}

void RoomFurnisher::hang_pictures(double spacing_m, double probability) {
  for (std::size_t edge = 0; edge < polygon_.size(); ++edge) {
    const double length = wall(edge).length_m;
    const auto places = static_cast<int>(length / spacing_m) + 1;
    for (int i = 0; i < places; ++i) {
      HungPicture picture;
      picture.edge = edge;
      picture.along_m = cm(length * (i + dice_(0.3, 0.7)) / places);
      const double width = dice_(0.4, 1.0);
      picture.size_m = {cm(width), cm(width * dice_(0.6, 1.3))};
      picture.height_m = cm(dice_(1.3, 1.55));
      if (dice_.chance(probability) && has_room_for(picture)) contents_.pictures.push_back(picture);
    }
  }
}

void RoomFurnisher::hang_low(const char* class_name, double share) {
  constexpr double kStepAside_m = 0.1;
  constexpr std::array<double, 3> kWidths_m{1.4, 0.9, 0.5};
  for (std::size_t edge = 0; edge < polygon_.size(); ++edge) {
    for (double along = 0.0; along < wall(edge).length_m; along += kStepAside_m) {
      for (const double width : kWidths_m) {
        HungPicture hung{class_name, edge, cm(along), cm(dice_(1.15, 1.3)), {width, cm(dice_(0.8, 1.0))}};
        if (!has_room_for(hung)) continue;
        if (dice_.chance(share)) {
          contents_.pictures.push_back(hung);
        } else {
          along += width;  // this stretch stays bare
        }
        break;
      }
    }
  }
}

void RoomFurnisher::hang_above(std::size_t index, const char* class_name, const Eigen::Vector2d& size_m,
                               double height_m) {
  if (!walls_of_[index]) return;
  HungPicture picture;
  picture.class_name = class_name;
  picture.edge = walls_of_[index]->first;
  picture.along_m = cm(walls_of_[index]->second);
  picture.size_m = size_m;
  picture.height_m = height_m;
  if (has_room_for(picture)) contents_.pictures.push_back(picture);
}

}  // namespace lapis::simulator
