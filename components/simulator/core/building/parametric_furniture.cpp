#include "simulator/core/building/parametric_furniture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/core/building/workshop.hpp"

namespace lapis::simulator {
namespace {

void chair(Workshop& s) {
  const auto frame = s.wood(), seat = s.dice.chance(0.5) ? s.fabric() : frame;
  const float t = 0.05F, seat_z = 0.5F * s.h;
  s.legs(t, seat_z, 0.01F, frame);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, seat_z, seat_z + 0.05F, seat);
  for (const float x : {-s.w / 2, s.w / 2 - t}) s.box(x, x + t, s.d / 2 - t, s.d / 2, seat_z, s.h, frame);
  for (const float z : {0.65F, 0.8F, 0.93F})
    s.box(-s.w / 2 + t, s.w / 2 - t, s.d / 2 - 0.03F, s.d / 2 - 0.01F, z * s.h, (z + 0.07F) * s.h, seat);
}

void table(Workshop& s) {
  const auto top = s.wood();
  s.legs(0.06F, s.h - 0.04F, 0.03F, s.dice.chance(0.7) ? top : s.metal());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.04F, s.h, top);
  for (const float y : {-s.d / 2 + 0.05F, s.d / 2 - 0.07F})
    s.box(-s.w / 2 + 0.06F, s.w / 2 - 0.06F, y, y + 0.02F, s.h - 0.12F, s.h - 0.04F, top);
}

/// A carcass whose front is divided into doors or drawers with handles.
void fronts(Workshop& s, float z0, float z1, int columns, int rows, std::uint32_t front, std::uint32_t handle) {
  s.box(-s.w / 2, s.w / 2, -s.d / 2 + 0.03F, s.d / 2, z0, z1, front);
  const float width = s.w / static_cast<float>(columns), height = (z1 - z0) / static_cast<float>(rows), gap = 0.006F;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const float x = -s.w / 2 + width * static_cast<float>(column), z = z0 + height * static_cast<float>(row);
      s.box(x + gap, x + width - gap, -s.d / 2 + 0.012F, -s.d / 2 + 0.035F, z + gap, z + height - gap, front);
      const bool is_drawer = height < width;
      const float hx = is_drawer ? x + 0.5F * width : x + (column % 2 == 0 ? 0.88F : 0.12F) * width;
      const float hz = z + (is_drawer ? 0.65F : 0.5F) * height, wide = is_drawer ? 0.06F : 0.01F;
      s.box(hx - wide, hx + wide, -s.d / 2, -s.d / 2 + 0.02F, hz - 0.07F + wide, hz + 0.07F - wide, handle);
    }
  }
}

void cabinet(Workshop& s) {
  const auto front = s.wood(), handle = s.dark();
  const int columns = std::max(1, static_cast<int>(std::lround(s.w / 0.5F)));
  fronts(s, 0.06F, s.h, columns, s.h > 1.4F ? 2 : 1, front, handle);
  s.box(-s.w / 2 + 0.03F, s.w / 2 - 0.03F, -s.d / 2 + 0.06F, s.d / 2, 0.0F, 0.06F, handle);
}

void chest_of_drawers(Workshop& s) {
  const auto front = s.wood();
  fronts(s, 0.06F, s.h, s.w > 1.0F ? 2 : 1, std::max(2, static_cast<int>(s.h / 0.25F)), front, s.metal());
  s.legs(0.05F, 0.06F, 0.02F, front);
}

void counter(Workshop& s) {
  const auto front = s.wood();
  fronts(s, 0.08F, s.h - 0.04F, std::max(1, static_cast<int>(std::lround(s.w / 0.6F))), 1, front, s.metal());
  s.box(-s.w / 2 + 0.01F, s.w / 2 - 0.01F, -s.d / 2 + 0.06F, s.d / 2, 0.0F, 0.08F, s.dark());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.04F, s.h, s.textured("concrete", {200, 196, 190}));
}

void cushion(Workshop& s) { s.shapes.ball({0.0F, 0.0F, s.h / 2}, {s.w / 2, s.d / 2, s.h / 2}, s.fabric()); }

/// Seat, back, arms.
void sofa(Workshop& s) {
  const auto cover = s.fabric(), legs = s.dark();
  const float arm = std::min(0.18F, 0.15F * s.w), seat = 0.55F * s.h, back = 0.28F * s.d;
  s.legs(0.05F, 0.08F, 0.04F, legs);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.08F, 0.35F * s.h, cover);
  for (const float x : {-s.w / 2, s.w / 2 - arm}) s.box(x, x + arm, -s.d / 2, s.d / 2, 0.35F * s.h, 0.72F * s.h, cover);
  s.box(-s.w / 2 + arm, s.w / 2 - arm, s.d / 2 - back, s.d / 2, 0.35F * s.h, s.h, cover);
  const int places = std::max(1, static_cast<int>(std::lround((s.w - 2 * arm) / 0.65F)));
  const float width = (s.w - 2 * arm) / static_cast<float>(places);
  for (int i = 0; i < places; ++i) {
    const float x = -s.w / 2 + arm + width * static_cast<float>(i);
    s.box(x + 0.01F, x + width - 0.01F, -s.d / 2 - 0.01F, s.d / 2 - back, 0.36F * s.h, seat, cover);
    s.box(x + 0.02F, x + width - 0.02F, s.d / 2 - back - 0.1F, s.d / 2 - back, seat, 0.95F * s.h, cover);
  }
}

void seating(Workshop& s) {
  const auto cover = s.fabric();
  s.legs(0.05F, 0.6F * s.h, 0.03F, s.metal());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.6F * s.h, s.h, cover);
}

void bed(Workshop& s) {
  const auto frame = s.wood(), sheet = s.white(), blanket = s.fabric(), pillow = s.fabric();
  const float top = std::min(0.5F, 0.6F * s.h);
  s.legs(0.08F, 0.2F * s.h, 0.0F, frame);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.2F * s.h, 0.5F * top, frame);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 0.06F, s.d / 2, 0.0F, s.h, frame);
  s.box(-s.w / 2 + 0.03F, s.w / 2 - 0.03F, -s.d / 2 + 0.03F, s.d / 2 - 0.06F, 0.5F * top, 0.92F * top, sheet);
  s.box(-s.w / 2 + 0.01F, s.w / 2 - 0.01F, -s.d / 2 + 0.01F, 0.2F * s.d, 0.6F * top, top, blanket);
  const int pillows = s.w > 1.2F ? 2 : 1;
  for (int i = 0; i < pillows; ++i) {
    const float x = s.w * ((static_cast<float>(i) + 0.5F) / static_cast<float>(pillows) - 0.5F);
    s.shapes.ball({x, 0.36F * s.d, top}, {std::min(0.35F, 0.42F * s.w), 0.18F, 0.09F}, pillow);
  }
}

/// Folds of cloth: upright strips that lie in front and behind by turns.
void curtain(Workshop& s) {
  const auto cloth = s.fabric();
  const int folds = std::max(4, static_cast<int>(s.w / 0.08F));
  const float width = s.w / static_cast<float>(folds);
  for (int i = 0; i < folds; ++i) {
    const float x = -s.w / 2 + width * static_cast<float>(i), y0 = (i % 2 == 0 ? -0.5F : 0.5F) * s.d, y1 = -y0;
    const float t = 0.01F;
    s.shapes.block({Eigen::Vector3f(x, y0 - t, 0),
                    {x + width, y1 - t, 0},
                    {x + width, y1 + t, 0},
                    {x, y0 + t, 0},
                    {x, y0 - t, s.h},
                    {x + width, y1 - t, s.h},
                    {x + width, y1 + t, s.h},
                    {x, y0 + t, s.h}},
                   cloth);
  }
}

void blinds(Workshop& s) {
  const auto slat = s.paint();
  const int count = std::clamp(static_cast<int>(s.h / 0.06F), 4, 30);
  const float step = s.h / static_cast<float>(count);
  for (int i = 0; i < count; ++i) {
    const float z = step * static_cast<float>(i);
    s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, z, z + 0.7F * step, slat);
  }
}

void plant(Workshop& s) {
  const auto leaf = s.textured("leaves"), stem = s.plain(90, 64, 40), pot = s.paint();
  const float pot_height = 0.28F * s.h;
  s.shapes.cylinder({0, 0, 0}, {0.2F * s.w, 0.2F * s.d}, {0.27F * s.w, 0.27F * s.d}, pot_height, pot);
  s.cylinder(0, 0, 0.9F * pot_height, 0.03F * s.w, 0.02F * s.w, 0.4F * s.h, stem, 6);
  for (int i = 0; i < 9; ++i) {
    const float angle = 2.4F * static_cast<float>(i), out = i == 0 ? 0.0F : 0.3F;
    const float size = static_cast<float>(s.dice(0.13, 0.2));
    const float z = s.h * static_cast<float>(s.dice(0.5, 0.85));
    s.shapes.ball({out * s.w * std::cos(angle), out * s.d * std::sin(angle), i == 0 ? 0.85F * s.h : z},
                  {size * s.w, size * s.d, 0.15F * s.h}, leaf, 6);
  }
}

/// A basin on a column, with a tap.
void sink(Workshop& s) {
  const auto white = s.white(), steel = s.metal();
  const float rim = 0.05F, bowl = std::min(0.16F, 0.5F * s.h), edge = s.h - 0.12F;
  if (edge > bowl) s.box(-0.12F * s.w, 0.12F * s.w, 0.0F, s.d / 2, 0.0F, edge - bowl, white);
  const float low = std::max(0.0F, edge - bowl);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, low, low + 0.03F, white);
  for (const float x : {-s.w / 2, s.w / 2 - rim}) s.box(x, x + rim, -s.d / 2, s.d / 2, low, edge, white);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, -s.d / 2 + rim, low, edge, white);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 2 * rim, s.d / 2, low, edge, white);
  s.cylinder(0, s.d / 2 - rim, edge, 0.02F, 0.02F, s.h - edge, steel, 8);
  s.box(-0.012F, 0.012F, s.d / 2 - 0.18F, s.d / 2 - rim, s.h - 0.03F, s.h - 0.005F, steel);
}

void bathtub(Workshop& s) {
  const auto white = s.white(), steel = s.metal();
  const float rim = 0.07F;
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.0F, 0.12F, white);
  for (const float x : {-s.w / 2, s.w / 2 - rim}) s.box(x, x + rim, -s.d / 2, s.d / 2, 0.12F, 0.92F * s.h, white);
  for (const float y : {-s.d / 2, s.d / 2 - rim}) s.box(-s.w / 2, s.w / 2, y, y + rim, 0.12F, 0.92F * s.h, white);
  s.box(-0.1F, 0.1F, s.d / 2 - 0.06F, s.d / 2 - 0.02F, 0.92F * s.h, s.h, steel);
}

void stairs(Workshop& s) {
  const auto step = s.wood();
  const int steps = std::max(2, static_cast<int>(std::lround(s.h / 0.18F)));
  for (int i = 0; i < steps; ++i) {
    const float y = -s.d / 2 + s.d * static_cast<float>(i) / static_cast<float>(steps);
    const float z = s.h * static_cast<float>(i) / static_cast<float>(steps);
    s.box(-s.w / 2, s.w / 2, y, s.d / 2, z, z + s.h / static_cast<float>(steps), step);
  }
}

void toilet(Workshop& s) {
  const auto white = s.white();
  const float seat = 0.52F * s.h;
  s.box(-s.w / 2, s.w / 2, 0.22F * s.d, s.d / 2, 0.48F * s.h, s.h, white);
  s.shapes.cylinder({0, -0.05F * s.d, 0}, {0.28F * s.w, 0.28F * s.d}, {0.45F * s.w, 0.42F * s.d}, 0.9F * seat, white);
  s.shapes.cylinder({0, -0.07F * s.d, 0.9F * seat}, {0.48F * s.w, 0.43F * s.d}, {0.48F * s.w, 0.43F * s.d}, 0.1F * seat,
                    s.plain(222, 222, 216));
  s.box(-0.06F, 0.06F, 0.3F * s.d, 0.4F * s.d, s.h, s.h + 0.01F, s.metal());
}

void stool(Workshop& s) {
  const auto wood = s.wood();
  s.legs(0.04F, s.h - 0.04F, 0.05F, wood);
  s.shapes.cylinder({0, 0, s.h - 0.04F}, {s.w / 2, s.d / 2}, {s.w / 2, s.d / 2}, 0.04F, wood, 16);
}

/// Cloth over a rail.
void towel(Workshop& s) {
  const auto cloth = s.fabric(), stripe = s.paint();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.02F, s.h, s.metal());
  s.box(-0.45F * s.w, 0.45F * s.w, -s.d / 2, -0.1F * s.d, 0.0F, s.h - 0.02F, cloth);
  s.box(-0.45F * s.w, 0.45F * s.w, 0.1F * s.d, s.d / 2, 0.2F * s.h, s.h - 0.02F, cloth);
  s.box(-0.45F * s.w, 0.45F * s.w, -0.53F * s.d, -0.5F * s.d, 0.12F * s.h, 0.2F * s.h, stripe);
}

/// A board whose rim is the frame of something flat on its front.
void framed(Workshop& s, std::uint32_t frame, std::uint32_t face) {
  const float rim = std::min(0.05F, 0.1F * s.w);
  s.box(-s.w / 2, s.w / 2, -s.d / 2 + 0.002F, s.d / 2, 0, s.h, frame);
  s.shapes.picture({-s.w / 2 + rim, -s.d / 2, rim}, {s.w - 2 * rim, 0, 0}, {0, 0, s.h - 2 * rim}, face);
}

void mirror(Workshop& s) {
  const auto frame = s.wood();
  framed(s, frame, s.textured("mirror"));
}

void board_panel(Workshop& s) {
  const auto frame = s.metal();
  framed(s, frame, s.painting(s.w / s.h));
}

void picture(Workshop& s) {
  const auto frame = s.wood();
  framed(s, frame, s.painting(s.w / s.h));
}

void tv_monitor(Workshop& s) {
  const auto black = s.dark();
  const float foot = 0.1F * s.h, t = std::min(0.05F, s.d);
  s.box(-0.2F * s.w, 0.2F * s.w, -s.d / 2, s.d / 2, 0, 0.02F, black);
  s.box(-0.04F * s.w, 0.04F * s.w, 0, 0.5F * t, 0.02F, foot + 0.1F * s.h, black);
  s.box(-s.w / 2, s.w / 2, -t / 2, t / 2, foot, s.h, black);
  s.shapes.picture({-0.48F * s.w, -t / 2 - 0.003F, foot + 0.03F * s.h}, {0.96F * s.w, 0, 0}, {0, 0, 0.84F * s.h},
                   s.painting(1.6));
}

/// Tray, two walls of frames, a pole with its head. Panes would be invisible.
void shower(Workshop& s) {
  const auto white = s.white(), steel = s.metal();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.06F, white);
  for (const float x : {-s.w / 2, s.w / 2 - 0.03F}) s.box(x, x + 0.03F, -s.d / 2, -s.d / 2 + 0.03F, 0.06F, s.h, steel);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, -s.d / 2 + 0.03F, s.h - 0.03F, s.h, steel);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 0.02F, s.d / 2, 0.06F, s.h, s.textured("wall_tiles", {200, 222, 226}));
  s.cylinder(0, s.d / 2 - 0.06F, 0.9F, 0.012F, 0.012F, s.h - 1.0F > 0.1F ? s.h - 1.0F : 0.1F, steel, 8);
  s.cylinder(0, s.d / 2 - 0.2F, s.h - 0.14F, 0.1F, 0.1F, 0.02F, steel);
}

void column(Workshop& s) {
  const auto stone = s.textured("concrete", {232, 228, 220});
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.1F, stone);
  s.shapes.cylinder({0, 0, 0.1F}, {0.45F * s.w, 0.45F * s.d}, {0.4F * s.w, 0.4F * s.d}, s.h - 0.2F, stone, 16);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.1F, s.h, stone);
}

void fireplace(Workshop& s) {
  const auto stone = s.textured("brick"), inside = s.dark(), fire = s.shining(255, 150, 60);
  const float side = 0.22F * s.w, top = 0.7F * s.h;
  for (const float x : {-s.w / 2, s.w / 2 - side}) s.box(x, x + side, -s.d / 2, s.d / 2, 0, top, stone);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, top, s.h - 0.06F, stone);
  s.box(-s.w / 2 + side, s.w / 2 - side, 0.4F * s.d, s.d / 2, 0, top, inside);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.06F, s.h, s.wood());
  for (const float x : {-0.12F, 0.0F, 0.1F})
    s.cylinder(x * s.w, 0.1F * s.d, 0, 0.05F * s.w, 0.0F, 0.35F * top, fire, 5);
}

/// A standing lamp.
void lighting(Workshop& s) {
  const auto pole = s.metal();
  s.shapes.cylinder({0, 0, 0}, {0.35F * s.w, 0.35F * s.d}, {0.35F * s.w, 0.35F * s.d}, 0.03F * s.h, pole);
  s.cylinder(0, 0, 0.03F * s.h, 0.03F * s.w, 0.03F * s.w, 0.75F * s.h, pole, 8);
  s.shapes.cylinder({0, 0, 0.76F * s.h}, {s.w / 2, s.d / 2}, {0.36F * s.w, 0.36F * s.d}, 0.24F * s.h,
                    s.shining(255, 240, 205), 14);
}

void railing(Workshop& s) {
  const auto steel = s.metal();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.05F, s.h, s.wood());
  const int bars = std::max(2, static_cast<int>(s.w / 0.12F));
  for (int i = 0; i <= bars; ++i) {
    const float x = (s.w - 0.02F) * (static_cast<float>(i) / static_cast<float>(bars) - 0.5F);
    s.box(x - 0.01F, x + 0.01F, -0.01F, 0.01F, 0, s.h - 0.05F, steel);
  }
}

/// Books of many colours and sizes on a board; some are left out.
void books(Workshop& s, float z, float height) {
  std::array<std::uint32_t, 6> covers{};
  for (auto& cover : covers) cover = s.paint();
  float x = -s.w / 2 + 0.04F;
  while (true) {
    const auto width = static_cast<float>(s.dice(0.02, 0.05)), tall = height * static_cast<float>(s.dice(0.6, 0.95));
    if (x + width > s.w / 2 - 0.04F) break;
    const auto front = -0.4F * s.d + 0.2F * s.d * static_cast<float>(s.dice(0.0, 1.0));
    const auto cover = covers[static_cast<std::size_t>(s.dice.whole(0, 5))];
    if (s.dice.chance(0.85)) s.box(x, x + width, front, 0.4F * s.d, z, z + tall, cover);
    x += width + 0.003F;
  }
}

void shelving(Workshop& s) {
  const auto wood = s.wood();
  const float t = 0.025F;
  for (const float x : {-s.w / 2, s.w / 2 - t}) s.box(x, x + t, -s.d / 2, s.d / 2, 0, s.h, wood);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 0.01F, s.d / 2, 0, s.h, wood);
  const int boards = std::max(2, static_cast<int>(std::lround(s.h / 0.36F)));
  const float step = (s.h - t) / static_cast<float>(boards);
  for (int i = 0; i <= boards; ++i) {
    const float z = step * static_cast<float>(i);
    s.box(-s.w / 2 + t, s.w / 2 - t, -s.d / 2, s.d / 2, z, z + t, wood);
    if (i < boards) books(s, z + t, step - t);
  }
}

/// A treadmill.
void gym_equipment(Workshop& s) {
  const auto black = s.dark(), steel = s.metal();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.14F * s.h, black);
  s.box(-0.35F * s.w, 0.35F * s.w, -0.48F * s.d, 0.4F * s.d, 0.14F * s.h, 0.15F * s.h,
        s.textured("fabric", {60, 60, 64}));
  for (const float x : {-s.w / 2, s.w / 2 - 0.06F}) {
    s.box(x, x + 0.06F, 0.36F * s.d, 0.44F * s.d, 0.14F * s.h, 0.85F * s.h, steel);
    s.box(x, x + 0.06F, 0.05F * s.d, 0.44F * s.d, 0.66F * s.h, 0.7F * s.h, steel);
  }
  s.box(-s.w / 2, s.w / 2, 0.34F * s.d, 0.5F * s.d, 0.82F * s.h, s.h, black);
  s.shapes.picture({-0.3F * s.w, 0.335F * s.d, 0.86F * s.h}, {0.6F * s.w, 0, 0}, {0, 0, 0.1F * s.h}, s.painting(2.0));
}

/// A refrigerator when it is high, otherwise an oven or a washing machine.
void appliances(Workshop& s) {
  const auto body = s.dice.chance(0.6) ? s.white() : s.plain(186, 188, 192), dark = s.dark(), steel = s.metal();
  s.box(-s.w / 2, s.w / 2, -s.d / 2 + 0.03F, s.d / 2, 0, s.h, body);
  const float split = s.h > 1.3F ? 0.65F * s.h : 0.8F * s.h, gap = 0.008F, front = -s.d / 2 + 0.01F;
  s.box(-s.w / 2 + gap, s.w / 2 - gap, front, -s.d / 2 + 0.04F, gap, split - gap, body);
  s.box(-s.w / 2 + gap, s.w / 2 - gap, front, -s.d / 2 + 0.04F, split + gap, s.h - gap, body);
  if (s.h > 1.3F) {
    for (const float z : {0.4F * s.h, 0.75F * s.h})
      s.box(0.38F * s.w, 0.41F * s.w, -s.d / 2, front, z, z + 0.2F * s.h, steel);
    return;
  }
  s.box(-0.32F * s.w, 0.32F * s.w, -s.d / 2 + 0.002F, front, 0.2F * s.h, 0.68F * s.h, dark);
  for (const float x : {-0.35F, -0.15F, 0.05F, 0.25F})
    s.box(x * s.w, (x + 0.08F) * s.w, -s.d / 2, front, 0.86F * s.h, 0.94F * s.h, dark);
}

/// Coats on hooks.
void clothes(Workshop& s) {
  s.box(-s.w / 2, s.w / 2, 0.3F * s.d, s.d / 2, 0.94F * s.h, s.h, s.wood());
  const int coats = std::max(1, static_cast<int>(s.w / 0.2F));
  const float width = s.w / static_cast<float>(coats);
  for (int i = 0; i < coats; ++i) {
    const float x = -s.w / 2 + width * (static_cast<float>(i) + 0.5F), r = 0.46F * width;
    const auto low = i == 0 ? 0.0F : s.h * static_cast<float>(s.dice(0.0, 0.35));
    s.shapes.cylinder({x, 0, low}, {r, s.d / 2}, {0.4F * r, 0.15F * s.d}, 0.95F * s.h - low, s.fabric(), 8);
  }
}

/// A pile of boxes with printed sides.
void objects(Workshop& s) {
  const auto print = s.textured("clutter"), plain = s.paint();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.55F * s.h, print);
  s.box(-0.4F * s.w, 0.25F * s.w, -0.4F * s.d, 0.4F * s.d, 0.55F * s.h, 0.8F * s.h, plain);
  s.cylinder(-0.1F * s.w, 0, 0.8F * s.h, 0.2F * std::min(s.w, s.d), 0.15F * std::min(s.w, s.d), 0.2F * s.h, print, 10);
}

void furniture(Workshop& s) {
  const auto wood = s.wood();
  s.legs(0.05F, 0.3F * s.h, 0.01F, wood);
  fronts(s, 0.3F * s.h, s.h, 1, 2, wood, s.metal());
}

void rug(Workshop& s) {
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.7F * s.h, s.fabric());
  s.shapes.picture({-0.48F * s.w, -0.48F * s.d, s.h}, {0.96F * s.w, 0, 0}, {0, 0.96F * s.d, 0}, s.painting(s.w / s.d));
}

void block(Workshop& s) { s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, s.h, s.wood()); }

struct FurnitureClass {
  const char* name;
  double width_m, depth_m, height_m;
  void (*make)(Workshop&);
};

constexpr FurnitureClass kOther{"", 0.5, 0.5, 0.5, block};
constexpr std::array kClasses{
    FurnitureClass{"chair", 0.46, 0.52, 0.9, chair},
    FurnitureClass{"table", 1.4, 0.8, 0.74, table},
    FurnitureClass{"cabinet", 1.0, 0.45, 1.2, cabinet},
    FurnitureClass{"cushion", 0.42, 0.42, 0.16, cushion},
    FurnitureClass{"sofa", 1.9, 0.88, 0.8, sofa},
    FurnitureClass{"bed", 1.6, 2.05, 0.95, bed},
    FurnitureClass{"curtain", 0.6, 0.1, 2.2, curtain},
    FurnitureClass{"chest_of_drawers", 0.9, 0.45, 0.85, chest_of_drawers},
    FurnitureClass{"plant", 0.5, 0.5, 1.1, plant},
    FurnitureClass{"sink", 0.55, 0.45, 0.95, sink},
    FurnitureClass{"stairs", 1.0, 2.4, 1.8, stairs},
    FurnitureClass{"toilet", 0.38, 0.65, 0.78, toilet},
    FurnitureClass{"stool", 0.36, 0.36, 0.46, stool},
    FurnitureClass{"towel", 0.5, 0.08, 0.7, towel},
    FurnitureClass{"mirror", 0.6, 0.04, 1.4, mirror},
    FurnitureClass{"tv_monitor", 1.0, 0.22, 0.65, tv_monitor},
    FurnitureClass{"shower", 0.9, 0.9, 2.1, shower},
    FurnitureClass{"column", 0.35, 0.35, 2.6, column},
    FurnitureClass{"bathtub", 1.7, 0.75, 0.58, bathtub},
    FurnitureClass{"counter", 1.8, 0.6, 0.9, counter},
    FurnitureClass{"fireplace", 1.3, 0.4, 1.1, fireplace},
    FurnitureClass{"lighting", 0.4, 0.4, 1.6, lighting},
    FurnitureClass{"beam", 3.0, 0.2, 0.2, block},
    FurnitureClass{"railing", 2.0, 0.06, 1.0, railing},
    FurnitureClass{"shelving", 0.9, 0.3, 1.9, shelving},
    FurnitureClass{"blinds", 1.2, 0.05, 1.2, blinds},
    FurnitureClass{"gym_equipment", 0.75, 1.7, 1.35, gym_equipment},
    FurnitureClass{"seating", 1.1, 0.42, 0.46, seating},
    FurnitureClass{"board_panel", 1.4, 0.04, 0.9, board_panel},
    FurnitureClass{"picture", 0.6, 0.03, 0.45, picture},
    FurnitureClass{"furniture", 0.6, 0.4, 0.6, furniture},
    FurnitureClass{"appliances", 0.6, 0.6, 0.86, appliances},
    FurnitureClass{"clothes", 0.8, 0.25, 1.1, clothes},
    FurnitureClass{"objects", 0.3, 0.22, 0.3, objects},
    FurnitureClass{"floor", 2.0, 1.4, 0.01, rug},
};

const FurnitureClass& class_of(const std::string& name) {
  const auto* it = std::find_if(kClasses.begin(), kClasses.end(),
                                [&](const FurnitureClass& candidate) { return candidate.name == name; });
  return it == kClasses.end() ? kOther : *it;
}

}  // namespace

Eigen::Vector3d default_size_m(const std::string& class_name) {
  const FurnitureClass& found = class_of(class_name);
  return {found.width_m, found.depth_m, found.height_m};
}

Mesh make_furniture(const std::string& class_name, const Eigen::Vector3d& size_m, std::uint64_t variant,
                    TextureLibrary& textures) {
  Mesh mesh;
  Workshop workshop(mesh, size_m, variant, textures);
  class_of(class_name).make(workshop);
  fit_to_box(mesh, size_m);
  return mesh;
}

}  // namespace lapis::simulator
