#include "simulator/core/looks/textures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "simulator/core/looks/canvas.hpp"
#include "simulator/core/looks/dice.hpp"

namespace lapis::simulator {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Adds random lightness to every pixel.
void add_grain(Canvas& canvas, const Random& random, float amplitude) {
  std::uint64_t index = 0;
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column)
      canvas(column, row).array() += amplitude * static_cast<float>(random.uniform(index++, -1.0, 1.0));
  }
}

/// Adds smooth variations of lightness.
void add_clouds(Canvas& canvas, const Random& random, int cells, float amplitude) {
  const TiledNoise noise(random, cells);
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const Eigen::Vector2f p = canvas.position(column, row);
      canvas(column, row).array() += amplitude * noise.at(p.x(), p.y());
    }
  }
}

/// Draws a line, and its copies in the neighbouring squares, so that the texture repeats.
void wrapped_line(Canvas& canvas, double x0, double y0, double x1, double y1, double thickness, const Paint& paint) {
  for (const int dx : {-1, 0, 1}) {
    for (const int dy : {-1, 0, 1}) canvas.line({x0 + dx, y0 + dy, x1 + dx, y1 + dy, thickness, paint});
  }
}

void scuffs(Canvas& canvas, Dice& dice, int count, float strength) {
  const Paint ground = canvas(0, 0);
  for (int i = 0; i < count; ++i) {
    const double x = dice(0, 1), y = dice(0, 1), angle = dice(0, 6.3), length = dice(0.005, 0.05);
    const Paint paint = ground.array() - strength * static_cast<float>(dice(0.3, 1.0));
    wrapped_line(canvas, x, y, x + length * std::cos(angle), y + length * std::sin(angle), dice(0.002, 0.006), paint);
  }
}

void plaster(Canvas& canvas, const Random& random, float roughness) {
  Dice dice(random);
  scuffs(canvas, dice, 14, 0.07F);
  add_clouds(canvas, random, 7, 0.008F);
  add_clouds(canvas, random, 53, 0.012F * roughness);
  add_grain(canvas, random, 0.018F * roughness);
}

void wallpaper_stripes(Canvas& canvas, const Random& random) {
  Dice dice(random);
  const int stripes = dice.whole(10, 20);
  const double share = dice(0.3, 0.6);
  const Paint paint = Paint::Constant(0.9F).array() - 0.5F * dice.color(0.1, 0.4).array() * 0.35F;
  for (int i = 0; i < stripes; ++i) canvas.rectangle({(i + 0.1) / stripes, 0, (i + 0.1 + share) / stripes, 1, paint});
  add_grain(canvas, random, 0.015F);
  add_clouds(canvas, random, 41, 0.01F);
}

void wallpaper_leaves(Canvas& canvas, const Random& random) {
  Dice dice(random);
  const Paint paint = Paint::Constant(0.92F) - 0.3F * dice.color();
  for (int i = 0; i < 110; ++i) {
    const double x = dice(0, 1), y = dice(0, 1), angle = dice(0, 6.3), length = dice(0.02, 0.05);
    const double dx = length * std::cos(angle), dy = length * std::sin(angle);
    wrapped_line(canvas, x, y, x + dx, y + dy, 0.004, paint);
    for (const double t : {0.3, 0.6, 0.9}) {
      for (const double bend : {0.7, -0.7}) {
        wrapped_line(canvas, x + t * dx, y + t * dy, x + t * dx + 0.4 * length * std::cos(angle + bend),
                     y + t * dy + 0.4 * length * std::sin(angle + bend), 0.006, paint);
      }
    }
  }
  add_grain(canvas, random, 0.012F);
}

void wallpaper_dots(Canvas& canvas, const Random& random) {
  Dice dice(random);
  const Paint first = Paint::Constant(0.92F) - 0.3F * dice.color(),
              second = Paint::Constant(0.92F) - 0.2F * dice.color();
  constexpr int kDots = 22;
  for (int row = 0; row < kDots; ++row) {
    for (int column = 0; column < kDots; ++column) {
      const double x = (column + (row % 2 == 0 ? 0.25 : 0.75)) / kDots, y = (row + 0.5) / kDots;
      const double radius = dice(0.006, 0.013);
      canvas.ellipse({x, y, radius, radius, dice.chance(0.5) ? first : second});
    }
  }
  add_grain(canvas, random, 0.012F);
}

/// Rows of rectangles with joints; each rectangle has one tone.
struct Pieces {
  int rows, columns;
  float joint;   ///< width, in units of the square
  bool shifted;  ///< every second row by half a piece
  float spread;  ///< of the tone, relative
  Paint tone, joint_tone;
};

void lay(Canvas& canvas, Dice& dice, const Pieces& pieces) {
  canvas.rectangle({0, 0, 1, 1, pieces.joint_tone});
  const double half_joint = pieces.joint / 2.0;
  for (int row = 0; row < pieces.rows; ++row) {
    const double shift = pieces.shifted && row % 2 == 1 ? 0.5 : 0.0;
    for (int column = 0; column < pieces.columns; ++column) {
      const Paint paint = pieces.tone * static_cast<float>(1.0 + dice(-1.0, 1.0) * pieces.spread);
      const double x = (column + shift) / pieces.columns, y = static_cast<double>(row) / pieces.rows;
      for (const int wrap : {-1, 0}) {
        canvas.rectangle({x + wrap + half_joint, y + half_joint, x + wrap + 1.0 / pieces.columns - half_joint,
                          y + 1.0 / pieces.rows - half_joint, paint});
      }
    }
  }
}

void brick(Canvas& canvas, const Random& random) {
  Dice dice(random);
  lay(canvas, dice, {32, 10, 0.006F, true, 0.18F, {0.66F, 0.36F, 0.28F}, Paint::Constant(0.74F)});
  add_clouds(canvas, random, 61, 0.04F);
  add_grain(canvas, random, 0.03F);
}

void wall_tiles(Canvas& canvas, const Random& random) {
  Dice dice(random);
  lay(canvas, dice, {10, 10, 0.006F, false, 0.03F, Paint::Constant(0.9F), Paint::Constant(0.7F)});
  add_clouds(canvas, random, 31, 0.012F);
}

void floor_tiles(Canvas& canvas, const Random& random) {
  Dice dice(random);
  const Paint tone = hsv({dice(0.05, 0.12), dice(0.05, 0.25), dice(0.6, 0.82)});
  lay(canvas, dice, {9, 9, 0.006F, false, 0.08F, tone, 0.75F * tone});
  add_clouds(canvas, random, 43, 0.03F);
  add_clouds(canvas, random, 97, 0.03F);
  add_grain(canvas, random, 0.012F);
}

/// Grain of wood along x, at a point of the square.
float wood_lines(const TiledNoise& noise, float x, float y, float rings) {
  const float bend = noise.at(x, y);
  return std::sin(2.0F * kPi * (rings * y + 1.5F * bend)) * 0.5F + 0.5F * noise.at(x * 2.0F, y * 5.0F);
}

struct Plank {
  double x0, x1;
  Paint paint;
  float offset;
};

/// The planks of a row. Lengths and tones differ; the last plank ends where the first one begins, so that rows repeat.
std::vector<Plank> row_of_planks(Dice& dice, int per_row, const Paint& tone) {
  std::vector<Plank> planks;
  double x = dice(0.0, 1.0);
  for (int i = 0; i < per_row; ++i) {
    const double end =
        i + 1 == per_row ? planks.empty() ? x + 1.0 : planks.front().x0 + 1.0 : x + dice(0.7, 1.15) / per_row;
    planks.push_back({x, end, tone * static_cast<float>(dice(0.78, 1.18)), static_cast<float>(dice(0.0, 1.0))});
    x = end;
  }
  return planks;
}

void lay_planks(Canvas& canvas, const Random& random, int rows, int per_row, const Paint& tone) {
  Dice dice(random);
  const TiledNoise noise(Random(random.bits(0), RandomStream::kTexture), 24);
  const float gap_x = 1.2F / static_cast<float>(canvas.width()), gap_y = 1.0F / static_cast<float>(canvas.height());
  for (int row = 0; row < rows; ++row) {
    const auto planks = row_of_planks(dice, per_row, tone);
    const double y0 = static_cast<double>(row) / rows, y1 = (row + 1.0) / rows;
    for (const Plank& plank : planks) {
      for (const int wrap : {-1, 0}) {
        canvas.rectangle({plank.x0 + wrap, y0, plank.x1 + wrap, y1, plank.paint});
        canvas.rectangle({plank.x1 + wrap - gap_x, y0, plank.x1 + wrap + gap_x, y1, 0.55F * tone});
      }
    }
    canvas.rectangle({0, y0, 1, y0 + gap_y, 0.55F * tone});
  }
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const Eigen::Vector2f p = canvas.position(column, row);
      canvas(column, row) *= 1.0F + 0.05F * wood_lines(noise, p.x(), p.y() * 3.0F, 8.0F);
    }
  }
}

void planks(Canvas& canvas, const Random& random) {
  Dice dice(Random(random.bits(1), RandomStream::kTexture));
  lay_planks(canvas, random, 20, 3, hsv({dice(0.06, 0.1), dice(0.35, 0.55), dice(0.5, 0.75)}));
  add_grain(canvas, random, 0.02F);
}

void parquet(Canvas& canvas, const Random& random) {
  Dice dice(Random(random.bits(1), RandomStream::kTexture));
  lay_planks(canvas, random, 40, 9, hsv({dice(0.06, 0.09), dice(0.4, 0.6), dice(0.45, 0.65)}));
  add_grain(canvas, random, 0.02F);
}

void carpet(Canvas& canvas, const Random& random) {
  Dice dice(random);
  canvas.rectangle({0, 0, 1, 1, hsv({dice(0, 1), dice(0.08, 0.35), dice(0.45, 0.7)})});
  scuffs(canvas, dice, 10, 0.05F);
  add_clouds(canvas, random, 9, 0.025F);
  add_clouds(canvas, random, 128, 0.05F);
  add_grain(canvas, random, 0.05F);
}

void concrete(Canvas& canvas, const Random& random) {
  Dice dice(random);
  canvas.rectangle({0, 0, 1, 1, Paint::Constant(0.66F)});
  scuffs(canvas, dice, 25, 0.12F);
  add_clouds(canvas, random, 5, 0.03F);
  add_clouds(canvas, random, 29, 0.025F);
  add_grain(canvas, random, 0.03F);
}

void blank(Canvas&, const Random&) {}

/// Light wood, for furniture; the material's colour makes it darker.
void wood(Canvas& canvas, const Random& random) {
  const TiledNoise noise(random, 6);
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const Eigen::Vector2f p = canvas.position(column, row);
      canvas(column, row) *= 0.9F + 0.09F * wood_lines(noise, p.x(), p.y(), 26.0F);
    }
  }
  add_grain(canvas, random, 0.02F);
}

void fabric(Canvas& canvas, const Random& random) {
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) {
      const bool is_over = (row / 3 + column / 3) % 2 == 0;
      canvas(column, row) *= is_over ? 0.98F : 0.9F;
    }
  }
  add_clouds(canvas, random, 37, 0.04F);
  add_grain(canvas, random, 0.03F);
}

void leaves(Canvas& canvas, const Random& random) {
  Dice dice(random);
  canvas.rectangle({0, 0, 1, 1, {0.14F, 0.3F, 0.12F}});
  for (int i = 0; i < 260; ++i) {
    const double x = dice(0, 1), y = dice(0, 1), angle = dice(0, 6.3), length = dice(0.03, 0.09);
    wrapped_line(canvas, x, y, x + length * std::cos(angle), y + length * std::sin(angle), dice(0.01, 0.03),
                 hsv({dice(0.24, 0.36), dice(0.5, 0.8), dice(0.25, 0.75)}));
  }
}

/// Dishes, boxes, bottles: things that stand about.
void clutter(Canvas& canvas, const Random& random) {
  Dice dice(random);
  for (int i = 0; i < 40; ++i) {
    const double x = dice(0, 1), y = dice(0, 1), w = dice(0.05, 0.3), h = dice(0.03, 0.2);
    canvas.rectangle({x, y, x + w, y + h, dice.color()});
    for (double line = y + 0.02; line + 0.01 < y + h; line += 0.025)
      canvas.line({x + 0.02, line, x + dice(0.3, 0.9) * w, line, 0.006, Paint::Constant(0.1F)});
  }
}

/// The view through a window: sky, hills, trees and houses.
void outdoor(Canvas& canvas, const Random& random) {
  Dice dice(random);
  canvas.gradient({0.0, 0.62, {0.62F, 0.8F, 1.0F}, {0.95F, 0.97F, 1.0F}});
  canvas.gradient({0.55, 1.0, {0.66F, 0.82F, 0.6F}, {0.5F, 0.68F, 0.42F}});
  for (int i = 0; i < 7; ++i)
    canvas.ellipse(
        {dice(0, 1), dice(0.55, 0.64), dice(0.1, 0.25), dice(0.03, 0.08), hsv({0.3, 0.25, dice(0.7, 0.85)})});
  for (int i = 0; i < 4; ++i) {
    const double x = dice(0, 0.85), w = dice(0.06, 0.14), y = dice(0.46, 0.56);
    canvas.rectangle({x, y, x + w, 0.66, hsv({dice(0.02, 0.15), 0.2, dice(0.7, 0.95)})});
    for (double u = 0.15; u < 0.8; u += 0.3)
      canvas.rectangle({x + u * w, y + 0.02, x + (u + 0.15) * w, y + 0.05, Paint::Constant(0.4F)});
  }
  for (int i = 0; i < 12; ++i) {
    const double x = dice(0, 1), y = dice(0.6, 0.8), size = dice(0.03, 0.07);
    canvas.line({x, y, x, y + size, 0.008, {0.45F, 0.36F, 0.28F}});
    canvas.ellipse({x, y - 0.3 * size, 0.6 * size, size, hsv({dice(0.24, 0.36), 0.45, dice(0.45, 0.7)})});
  }
  add_grain(canvas, random, 0.01F);
}

/// A mirror shows a soft, bright room without detail.
void mirror(Canvas& canvas, const Random& random) {
  Dice dice(random);
  canvas.gradient({0.0, 1.0, {0.95F, 0.97F, 0.98F}, {0.66F, 0.7F, 0.72F}});
  for (int i = 0; i < 3; ++i) {
    const double x = dice(0.0, 0.8);
    canvas.line({x, 1.1, x + 0.3, -0.1, dice(0.02, 0.08), {0.97F, 0.99F, 1.0F}});
  }
}

struct Surface {
  const char* name;
  int size_px;
  double period_m;
  void (*paint)(Canvas&, const Random&);
};

constexpr std::array kSurfaces{
    Surface{"plaster", 512, 2.5, [](Canvas& canvas, const Random& random) { plaster(canvas, random, 1.0F); }},
    Surface{"rough_plaster", 512, 2.0, [](Canvas& canvas, const Random& random) { plaster(canvas, random, 2.5F); }},
    Surface{"wallpaper_stripes", 512, 2.5, wallpaper_stripes},
    Surface{"wallpaper_leaves", 512, 2.5, wallpaper_leaves},
    Surface{"wallpaper_dots", 512, 2.5, wallpaper_dots},
    Surface{"brick", 512, 2.4, brick},
    Surface{"wall_tiles", 512, 1.5, wall_tiles},
    Surface{"concrete", 512, 3.0, concrete},
    Surface{"blank", 4, 1.0, blank},
    Surface{"planks", 512, 3.0, planks},
    Surface{"parquet", 512, 3.0, parquet},
    Surface{"tiles", 512, 2.7, floor_tiles},
    Surface{"carpet", 512, 2.5, carpet},
    Surface{"wood", 256, 0.8, wood},
    Surface{"fabric", 256, 0.5, fabric},
    Surface{"leaves", 128, 0.5, leaves},
    Surface{"clutter", 256, 0.5, clutter},
    Surface{"outdoor", 256, 2.0, outdoor},
    Surface{"mirror", 128, 1.0, mirror},
};

const Surface& surface_of(const std::string& name) {
  const auto has_name = [&](const Surface& surface) { return surface.name == name; };
  const auto* it = std::find_if(kSurfaces.begin(), kSurfaces.end(), has_name);
  if (it == kSurfaces.end()) throw std::runtime_error("no texture is called \"" + name + "\"");
  return *it;
}

}  // namespace

std::vector<std::string> texture_names() {
  std::vector<std::string> names;
  for (const Surface& surface : kSurfaces) names.emplace_back(surface.name);
  return names;
}

bool is_texture(const std::string& name) {
  return std::any_of(kSurfaces.begin(), kSurfaces.end(), [&](const Surface& surface) { return surface.name == name; });
}

double texture_period_m(const std::string& name) { return surface_of(name).period_m; }

TextureImage make_texture(const std::string& name, std::uint64_t seed, double richness) {
  const Surface& surface = surface_of(name);
  const auto number = static_cast<std::uint64_t>(&surface - kSurfaces.data());
  Canvas canvas(surface.size_px, surface.size_px, Paint::Constant(0.94F));
  surface.paint(canvas, Random(seed, RandomStream::kTexture, number));
  return canvas.image(richness);
}

std::shared_ptr<const TextureImage> TextureLibrary::surface(const std::string& name, std::uint64_t seed) {
  auto& texture = made_[{name, seed}];
  if (!texture) texture = std::make_shared<const TextureImage>(make_texture(name, seed, richness_));
  return texture;
}

}  // namespace lapis::simulator
