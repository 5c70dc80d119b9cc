#include "simulator/core/furniture/furniture_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapis::simulator {
namespace {

/// Folds of cloth: upright strips that slant forwards and backwards by turns.
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

/// A pane of glass between two posts on feet: no camera sees it, and nothing passes through it.
void glass_screen(Workshop& s) {
  const auto steel = s.metal();
  const float post = 0.03F;
  for (const float x : {-s.w / 2, s.w / 2 - post}) {
    s.box(x, x + post, -s.d / 2, s.d / 2, 0, 0.03F, steel);
    s.box(x, x + post, -post / 2, post / 2, 0.03F, s.h, steel);
  }
  s.shapes.picture({-s.w / 2 + post, 0, 0.03F}, {s.w - 2 * post, 0, 0}, {0, 0, s.h - 0.03F}, s.shapes.glass("glass"));
}

void board_panel(Workshop& s) {
  const auto frame = s.metal();
  framed(s, frame, s.painting(s.w / s.h));
}

void picture(Workshop& s) {
  const auto frame = s.wood();
  framed(s, frame, s.painting(s.w / s.h));
}

/// A tray, a frame in front, a tiled back wall, and a pole with its head. There are no panes: they would be invisible.
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

constexpr std::array kFixtureClasses{
    FurnitureClass{"curtain", 0.6, 0.1, 2.2, curtain},     FurnitureClass{"sink", 0.55, 0.45, 0.95, sink},
    FurnitureClass{"stairs", 1.0, 2.4, 1.8, stairs},       FurnitureClass{"toilet", 0.38, 0.65, 0.78, toilet},
    FurnitureClass{"towel", 0.5, 0.08, 0.7, towel},        FurnitureClass{"mirror", 0.6, 0.04, 1.4, mirror},
    FurnitureClass{"shower", 0.9, 0.9, 2.1, shower},       FurnitureClass{"column", 0.35, 0.35, 2.6, column},
    FurnitureClass{"bathtub", 1.7, 0.75, 0.58, bathtub},   FurnitureClass{"fireplace", 1.3, 0.4, 1.1, fireplace},
    FurnitureClass{"lighting", 0.4, 0.4, 1.6, lighting},   FurnitureClass{"railing", 2.0, 0.06, 1.0, railing},
    FurnitureClass{"blinds", 1.2, 0.05, 1.2, blinds},      FurnitureClass{"board_panel", 1.4, 0.04, 0.9, board_panel},
    FurnitureClass{"picture", 0.6, 0.03, 0.45, picture},   FurnitureClass{"appliances", 0.6, 0.6, 0.86, appliances},
    FurnitureClass{"window", 1.4, 0.3, 1.9, glass_screen},
};

}  // namespace

std::span<const FurnitureClass> fixture_classes() { return kFixtureClasses; }

}  // namespace lapis::simulator
