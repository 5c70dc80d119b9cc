#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulator/core/looks/canvas.hpp"
#include "simulator/core/looks/dice.hpp"
#include "simulator/core/looks/textures.hpp"

namespace lapis::simulator {
namespace {

const Paint kInk = Paint::Constant(0.1F);
const Paint kPaper{0.95F, 0.93F, 0.87F};

struct Spot {
  double x, y, size;
};

void tree(Canvas& canvas, Dice& dice, const Spot& spot) {
  const auto [x, y, size] = spot;
  canvas.line({x, y, x, y - size, 0.2 * size, {0.32F, 0.22F, 0.14F}});
  const double hue = dice(0.2, 0.4);
  for (int i = 0; i < 9; ++i) {
    canvas.ellipse({x + dice(-0.35, 0.35) * size, y - size * dice(0.7, 1.5), dice(0.1, 0.25) * size,
                    dice(0.1, 0.25) * size, hsv({hue, 0.6, dice(0.25, 0.75)})});
  }
}

void house(Canvas& canvas, Dice& dice, const Spot& spot) {
  const auto [x, y, size] = spot;
  const Paint wall = dice.color(0.05, 0.35);
  canvas.rectangle({x, y - size, x + size, y, wall});
  canvas.triangle({{x - 0.1 * size, y - size},
                   {x + 1.1 * size, y - size},
                   {x + 0.5 * size, y - 1.6 * size},
                   hsv({dice(0.0, 0.08), 0.7, dice(0.35, 0.7)})});
  for (const double u : {0.15, 0.6}) {
    canvas.rectangle({x + u * size, y - 0.8 * size, x + (u + 0.22) * size, y - 0.5 * size, kInk});
    canvas.line({x + (u + 0.11) * size, y - 0.8 * size, x + (u + 0.11) * size, y - 0.5 * size, 0.03 * size, wall});
  }
  canvas.rectangle({x + 0.4 * size, y - 0.35 * size, x + 0.58 * size, y, {0.3F, 0.18F, 0.1F}});
}

void landscape(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 0.6, hsv({dice(0.5, 0.65), dice(0.3, 0.6), 0.9}), hsv({dice(0.02, 0.15), 0.3, 0.97})});
  canvas.ellipse({dice(0.1, 0.9), dice(0.1, 0.3), 0.05, 0.07, {1.0F, 0.93F, 0.65F}});
  for (int i = 0; i < 7; ++i) {
    const double x = dice(0, 1), height = dice(0.15, 0.35), half = dice(0.1, 0.25);
    canvas.triangle(
        {{x - half, 0.62}, {x + half, 0.62}, {x, 0.62 - height}, hsv({dice(0.55, 0.7), 0.3, dice(0.3, 0.6)})});
    canvas.triangle({{x - half * 0.3, 0.62 - height * 0.7},
                     {x + half * 0.3, 0.62 - height * 0.7},
                     {x, 0.62 - height},
                     Paint::Constant(0.95F)});
  }
  canvas.gradient({0.6, 1.0, hsv({dice(0.2, 0.35), 0.5, 0.65}), hsv({dice(0.15, 0.35), 0.6, 0.4})});
  for (int i = 0; i < 3; ++i) house(canvas, dice, {dice(0.05, 0.85), dice(0.68, 0.85), dice(0.07, 0.13)});
  for (int i = 0; i < 12; ++i) tree(canvas, dice, {dice(0, 1), dice(0.7, 0.98), dice(0.06, 0.16)});
}

void sea(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 0.5, hsv({dice(0.5, 0.6), 0.4, 0.9}), {0.98F, 0.9F, 0.8F}});
  canvas.gradient({0.5, 1.0, hsv({dice(0.5, 0.62), 0.5, 0.7}), hsv({dice(0.52, 0.64), 0.7, 0.4})});
  for (int i = 0; i < 120; ++i) {
    const double y = 0.52 + 0.47 * std::pow(dice(0, 1), 1.5), x = dice(0, 1), length = 0.08 * y * dice(0.3, 1.0);
    canvas.line({x, y, x + length, y + dice(-0.01, 0.01), 0.008, hsv({0.55, dice(0.0, 0.5), dice(0.5, 1.0)})});
  }
  for (int i = 0; i < 6; ++i) {
    const double x = dice(0.05, 0.95), y = dice(0.55, 0.85), size = 0.3 * (y - 0.4);
    canvas.triangle({{x, y - 0.05}, {x, y - size * 2}, {x + size, y - 0.05}, dice.color(0.0, 0.7)});
    canvas.triangle({{x - 0.01, y - 0.05}, {x - 0.01, y - size * 1.6}, {x - 0.6 * size, y - 0.05}, kPaper});
    canvas.line({x - 0.6 * size, y, x + size, y, 0.2 * size, {0.35F, 0.2F, 0.12F}});
  }
}

void skyline(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 1, hsv({dice(0, 1), 0.5, 0.35}), hsv({dice(0, 1), 0.5, 0.95})});
  for (int layer = 0; layer < 3; ++layer) {
    for (double x = dice(-0.1, 0.0); x < 1.0;) {
      const double width = dice(0.05, 0.14), top = dice(0.15, 0.5) + 0.15 * layer;
      canvas.rectangle({x, top, x + width, 1, hsv({0.6, 0.3, 0.5 - 0.13 * layer})});
      for (double v = top + 0.03; v < 0.95; v += 0.05) {
        for (double u = x + 0.012; u + 0.015 < x + width; u += 0.025) {
          if (dice.chance(0.5)) canvas.rectangle({u, v, u + 0.013, v + 0.025, hsv({0.14, dice(0.2, 0.7), 0.95})});
        }
      }
      x += width + dice(0.0, 0.02);
    }
  }
}

/// Divides a rectangle into coloured ones, again and again, in the manner of De Stijl.
void split(Canvas& canvas, Dice& dice, double x0, double y0, double x1, double y1, int depth) {
  if (depth == 0 || (depth < 5 && dice.chance(0.15))) {
    canvas.rectangle({x0, y0, x1, y1, kInk});
    canvas.rectangle(
        {x0 + 0.008, y0 + 0.008, x1 - 0.008, y1 - 0.008, dice.chance(0.45) ? kPaper : dice.color(0.6, 0.95)});
    return;
  }
  const double cut = dice(0.3, 0.7);
  if ((x1 - x0) > (y1 - y0)) {
    split(canvas, dice, x0, y0, x0 + cut * (x1 - x0), y1, depth - 1);
    split(canvas, dice, x0 + cut * (x1 - x0), y0, x1, y1, depth - 1);
  } else {
    split(canvas, dice, x0, y0, x1, y0 + cut * (y1 - y0), depth - 1);
    split(canvas, dice, x0, y0 + cut * (y1 - y0), x1, y1, depth - 1);
  }
}

void rectangles(Canvas& canvas, Dice& dice) { split(canvas, dice, 0, 0, 1, 1, 8); }

void circles(Canvas& canvas, Dice& dice) {
  canvas.rectangle({0, 0, 1, 1, dice.color(0.05, 0.3)});
  for (int i = 0; i < 22; ++i) {
    const double x = dice(0, 1), y = dice(0, 1), radius = dice(0.03, 0.16);
    for (double share = 1.0; share > 0.15; share -= dice(0.15, 0.4))
      canvas.ellipse({x, y, radius * share * 0.8, radius * share, dice.color(0.3, 0.95)});
  }
  for (int i = 0; i < 14; ++i) canvas.line({dice(0, 1), dice(0, 1), dice(0, 1), dice(0, 1), dice(0.004, 0.012), kInk});
}

void tone_grid(Canvas& canvas, Dice& dice) {
  const int columns = dice.whole(6, 11), rows = dice.whole(5, 9);
  const double hue = dice(0, 1), spread = dice(0.05, 0.5);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = static_cast<double>(column) / columns, y = static_cast<double>(row) / rows;
      const auto tone = [&] { return hsv({hue + dice(-spread, spread), dice(0.2, 0.9), dice(0.25, 1.0)}); };
      canvas.rectangle({x, y, x + 1.0 / columns, y + 1.0 / rows, tone()});
      if (dice.chance(0.6)) {
        canvas.ellipse({x + 0.5 / columns, y + 0.5 / rows, dice(0.2, 0.4) / columns, dice(0.2, 0.4) / rows, tone()});
      }
    }
  }
}

void portrait(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 1, dice.color(0.2, 0.5), dice.color(0.2, 0.6)});
  for (int i = 0; i < 25; ++i) {
    const double x = dice(0, 1), y = dice(0, 1);
    canvas.line({x, y, x + dice(-0.1, 0.1), y + dice(-0.1, 0.1), 0.02, dice.color(0.2, 0.5)});
  }
  const double x = dice(0.4, 0.6), y = dice(0.36, 0.44), size = dice(0.16, 0.22);
  const Paint skin = hsv({dice(0.04, 0.09), dice(0.25, 0.6), dice(0.45, 0.95)}), hair = dice.color(0.3, 0.6) * 0.5F;
  canvas.ellipse({x, 1.0, 0.38, 0.38, dice.color(0.4, 0.8)});
  for (int i = 0; i < 5; ++i) canvas.ellipse({x, 0.7 + 0.07 * i, 0.012, 0.018, dice.color()});
  canvas.rectangle({x - 0.4 * size, y, x + 0.4 * size, y + 1.6 * size, skin * 0.9F});
  canvas.ellipse({x, y - 0.25 * size, size * 1.05, size * 1.25, hair});
  canvas.ellipse({x, y, size * 0.85, size * 1.15, skin});
  for (const double eye : {-0.35, 0.35}) {
    canvas.ellipse({x + eye * size, y - 0.1 * size, 0.18 * size, 0.12 * size, Paint::Constant(0.97F)});
    canvas.ellipse({x + (eye + dice(-0.04, 0.04)) * size, y - 0.1 * size, 0.08 * size, 0.1 * size, kInk});
    canvas.line({x + (eye - 0.2) * size, y - 0.35 * size, x + (eye + 0.2) * size, y - dice(0.3, 0.45) * size,
                 0.06 * size, hair});
  }
  canvas.line({x, y - 0.05 * size, x + 0.08 * size, y + 0.3 * size, 0.05 * size, skin * 0.7F});
  canvas.line({x - 0.25 * size, y + 0.6 * size, x + 0.25 * size, y + dice(0.52, 0.66) * size, 0.09 * size,
               hsv({0.0, 0.6, 0.6})});
}

void text(Canvas& canvas, Dice& dice) {
  canvas.rectangle({0, 0, 1, 1, dice.chance(0.6) ? kPaper : dice.color(0.3, 0.7)});
  const Paint ink = dice.chance(0.7) ? kInk : dice.color(0.7, 1.0) * 0.5F;
  double y = 0.06;
  while (y < 0.94) {
    const double height = dice.chance(0.25) ? dice(0.07, 0.12) : dice(0.025, 0.04);
    for (double x = dice.chance(0.3) ? 0.2 : 0.06; x < dice(0.6, 0.93);) {
      const double width = height * dice(0.35, 0.6);
      if (dice.chance(0.85)) {  // a letter: two strokes or three
        canvas.rectangle({x, y, x + 0.3 * width, y + height, ink});
        canvas.rectangle({x, y + (dice.chance(0.5) ? 0.0 : 0.4 * height), x + width, y + 0.6 * height, ink});
        if (dice.chance(0.5)) canvas.rectangle({x + 0.7 * width, y, x + width, y + height, ink});
      }
      x += 1.35 * width;
    }
    y += 1.5 * height;
  }
}

void map(Canvas& canvas, Dice& dice) {
  const TiledNoise coarse(Random(static_cast<std::uint64_t>(dice(0, 1e9)), RandomStream::kTexture), 4);
  const TiledNoise fine(Random(static_cast<std::uint64_t>(dice(0, 1e9)), RandomStream::kTexture), 15);
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const Eigen::Vector2f p = canvas.position(column, row);
      const float height = coarse.at(p.x(), p.y()) + 0.35F * fine.at(p.x(), p.y());
      const int step = std::clamp(static_cast<int>(std::floor(height * 5.0F)), -2, 5);
      canvas(column, row) =
          step < 0 ? hsv({0.57, 0.35 - 0.1 * step, 0.9}) : hsv({0.3 - 0.05 * step, 0.4, 0.9 - 0.06 * step});
    }
  }
  for (int i = 1; i < 8; ++i) {
    canvas.line({i / 8.0, 0, i / 8.0, 1, 0.003, kPaper * 0.7F});
    canvas.line({0, i / 8.0, 1, i / 8.0, 0.003, kPaper * 0.7F});
  }
  for (int i = 0; i < 30; ++i) {
    const double x = dice(0.03, 0.9), y = dice(0.03, 0.97);
    canvas.rectangle({x, y, x + 0.012, y + 0.014, dice.chance(0.5) ? kInk : hsv({0, 0.8, 0.8})});
    for (int letter = 0; letter < dice.whole(3, 7); ++letter)
      canvas.rectangle({x + 0.02 + 0.012 * letter, y - 0.01, x + 0.027 + 0.012 * letter, y + dice(0.0, 0.012), kInk});
  }
}

void flowers(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 0.75, dice.color(0.1, 0.4), dice.color(0.1, 0.3)});
  canvas.rectangle({0, 0.75, 1, 1, dice.color(0.3, 0.6) * 0.7F});
  const Paint vase = dice.color(0.3, 0.8);
  for (int i = 0; i < 20; ++i) {
    const double x = dice(0.15, 0.85), y = dice(0.08, 0.5), size = dice(0.03, 0.065);
    canvas.line({0.5, 0.65, x, y, 0.008, hsv({0.33, 0.6, dice(0.3, 0.6)})});
    const Paint petal = dice.color(0.5, 0.95);
    const int petals = dice.whole(5, 8);
    for (int k = 0; k < petals; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / petals;
      canvas.ellipse({x + size * 0.8 * std::cos(angle), y + size * std::sin(angle), 0.45 * size, 0.5 * size, petal});
    }
    canvas.ellipse({x, y, 0.4 * size, 0.45 * size, hsv({dice(0.08, 0.17), 0.8, 0.9})});
  }
  canvas.triangle({{0.36, 0.62}, {0.64, 0.62}, {0.5, 1.05}, vase});
  canvas.ellipse({0.5, 0.76, 0.12, 0.15, vase});
  for (int i = 0; i < 6; ++i) canvas.line({0.39, 0.68 + 0.03 * i, 0.61, 0.66 + 0.03 * i, 0.006, kPaper * 0.8F});
}

void waves(Canvas& canvas, Dice& dice) {
  const int bands = dice.whole(9, 16);
  for (int i = 0; i < bands; ++i) {
    const double base = static_cast<double>(i) / bands, size = dice(0.02, 0.08), rate = dice(1.0, 4.0),
                 phase = dice(0, 6.3);
    const Paint paint = dice.color(0.2, 0.9);
    for (double x = 0.0; x < 1.0; x += 0.01) {
      const double y = base + size * std::sin(2.0 * std::numbers::pi * rate * x + phase);
      canvas.rectangle({x, y, x + 0.011, 1.0, paint});
    }
    for (int k = 0; k < 8; ++k) canvas.ellipse({dice(0, 1), base + dice(0.0, 0.1), 0.012, 0.014, dice.color(0.0, 0.9)});
  }
}

void mosaic(Canvas& canvas, Dice& dice) {
  const int columns = dice.whole(6, 10), rows = dice.whole(5, 8);
  std::vector<Eigen::Vector2d> nodes;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      nodes.emplace_back((column + dice(-0.35, 0.35)) / columns, (row + dice(-0.35, 0.35)) / rows);
    }
  }
  canvas.rectangle({0, 0, 1, 1, dice.color(0.2, 0.6)});
  const double hue = dice(0, 1), spread = dice(0.1, 0.5);
  const auto node = [&](int column, int row) {
    const int index = row * (columns + 1) + column;
    return nodes[static_cast<std::size_t>(index)];
  };
  const auto tone = [&] { return hsv({hue + dice(-spread, spread), dice(0.3, 0.9), dice(0.25, 0.98)}); };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      canvas.triangle({node(column, row), node(column + 1, row), node(column, row + 1), tone()});
      canvas.triangle({node(column + 1, row), node(column + 1, row + 1), node(column, row + 1), tone()});
    }
  }
}

void branch(Canvas& canvas, Dice& dice, double x, double y, double angle, double length, int depth) {
  const double x1 = x + length * std::cos(angle), y1 = y - length * std::sin(angle);
  canvas.line({x, y, x1, y1, 0.09 * length, {0.25F, 0.17F, 0.12F}});
  if (depth == 0) {
    canvas.ellipse({x1, y1, dice(0.01, 0.02), dice(0.012, 0.025), dice.color(0.4, 0.9)});
    return;
  }
  for (int i = 0; i < 3; ++i)
    branch(canvas, dice, x1, y1, angle + dice(-0.8, 0.8), length * dice(0.6, 0.85), depth - 1);
}

void branches(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 1, dice.color(0.05, 0.3), dice.color(0.05, 0.2)});
  branch(canvas, dice, dice(0.3, 0.7), 1.0, 1.57 + dice(-0.2, 0.2), dice(0.22, 0.28), 4);
}

void chart(Canvas& canvas, Dice& dice) {
  canvas.rectangle({0, 0, 1, 1, kPaper});
  canvas.rectangle({0.05, 0.04, dice(0.4, 0.9), 0.1, dice.color(0.6, 0.9)});
  const int bars = dice.whole(7, 14);
  for (int i = 0; i < bars; ++i) {
    const double x = 0.08 + 0.86 * i / bars;
    canvas.rectangle({x, dice(0.2, 0.5), x + 0.6 / bars, 0.55, dice.color(0.4, 0.9)});
  }
  canvas.line({0.05, 0.55, 0.96, 0.55, 0.008, kInk});
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      const double x = 0.06 + 0.13 * column, y = 0.6 + 0.075 * row;
      canvas.rectangle({x, y, x + 0.11, y + 0.06, dice.chance(0.2) ? dice.color(0.3, 0.6) : Paint::Constant(0.85F)});
      for (int k = 0; k < dice.whole(1, 4); ++k)
        canvas.rectangle({x + 0.01 + 0.02 * k, y + 0.015, x + 0.022 + 0.02 * k, y + dice(0.03, 0.05), kInk});
    }
  }
}

void still_life(Canvas& canvas, Dice& dice) {
  canvas.gradient({0, 0.6, dice.color(0.3, 0.6) * 0.4F, dice.color(0.3, 0.6) * 0.6F});
  canvas.gradient({0.6, 1, hsv({dice(0.05, 0.1), 0.5, 0.6}), hsv({0.07, 0.6, 0.35})});
  for (int i = 0; i < 4; ++i) {  // bottles with labels
    const double x = dice(0.1, 0.8), width = dice(0.06, 0.1), top = dice(0.15, 0.4), foot = dice(0.65, 0.8);
    const Paint glass = dice.color(0.3, 0.8) * 0.8F;
    canvas.rectangle({x, top + 0.15, x + width, foot, glass});
    canvas.rectangle({x + 0.35 * width, top, x + 0.65 * width, top + 0.16, glass});
    canvas.rectangle({x, top + 0.25, x + width, foot - 0.08, kPaper});
    for (double y = top + 0.27; y < foot - 0.1; y += 0.03)
      canvas.line({x + 0.01, y, x + dice(0.5, 0.9) * width, y, 0.01, kInk});
  }
  for (int i = 0; i < 14; ++i) {
    const double x = dice(0.05, 0.95), y = dice(0.68, 0.92), radius = dice(0.03, 0.06);
    canvas.ellipse({x, y, radius * 0.85, radius, dice.color(0.6, 0.95)});
    canvas.ellipse({x - 0.3 * radius, y - 0.35 * radius, 0.2 * radius, 0.2 * radius, Paint::Constant(0.95F)});
  }
}

using Motif = void (*)(Canvas&, Dice&);
constexpr std::array<Motif, 15> kMotifs{landscape, rectangles, portrait, map,    flowers,  text,  circles,   skyline,
                                        sea,       tone_grid,  waves,    mosaic, branches, chart, still_life};

/// Adds brush strokes, so that no area is uniform, and a signature.
void finish(Canvas& canvas, Dice& dice, const Random& random) {
  const TiledNoise strokes(random, 60);
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const Eigen::Vector2f p = canvas.position(column, row);
      canvas(column, row) *= 1.0F + 0.05F * strokes.at(p.x(), p.y());
    }
  }
  for (int i = 0; i < 10; ++i) {  // a signature
    const double x = 0.8 + 0.015 * i;
    canvas.line({x, 0.96 + dice(-0.01, 0.01), x + 0.012, 0.96 + dice(-0.015, 0.015), 0.006, kInk});
  }
}

}  // namespace

TextureImage make_picture(std::uint64_t motif, double aspect, double richness) {
  constexpr int kLonger_px = 256;
  const auto shorter = [](double share) { return std::max(8, static_cast<int>(std::lround(kLonger_px * share))); };
  Canvas canvas(aspect >= 1.0 ? kLonger_px : shorter(aspect), aspect >= 1.0 ? shorter(1.0 / aspect) : kLonger_px,
                kPaper);
  const Random random(motif, RandomStream::kTexture, 1'000'000);
  Dice dice(random);
  kMotifs[motif % kMotifs.size()](canvas, dice);
  finish(canvas, dice, random);
  return canvas.image(richness);
}

}  // namespace lapis::simulator
