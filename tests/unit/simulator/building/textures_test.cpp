#include "simulator/core/looks/textures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lapis::simulator {
namespace {

double difference(const Rgba8& a, const Rgba8& b) {
  return (std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b)) / 3.0;
}

/// Mean absolute difference of two images of one size, in grey values.
double difference(const TextureImage& a, const TextureImage& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += difference(a.pixels[i], b.pixels[i]);
  return sum / static_cast<double>(a.pixels.size());
}

/// Mean difference of neighbouring columns, between `column` and the next one (around the border).
double step_after(const TextureImage& image, int column) {
  double sum = 0.0;
  for (int row = 0; row < image.height; ++row)
    sum += difference(image(column, row), image((column + 1) % image.width, row));
  return sum / image.height;
}

double step_below(const TextureImage& image, int row) {
  double sum = 0.0;
  for (int column = 0; column < image.width; ++column)
    sum += difference(image(column, row), image(column, (row + 1) % image.height));
  return sum / image.width;
}

/// Pixels with strong steps to the right and below: a rough count of corners.
int corners(const TextureImage& image) {
  int count = 0;
  for (int row = 0; row + 1 < image.height; ++row) {
    for (int column = 0; column + 1 < image.width; ++column) {
      const auto& pixel = image(column, row);
      count += difference(pixel, image(column + 1, row)) > 20 && difference(pixel, image(column, row + 1)) > 20 ? 1 : 0;
    }
  }
  return count;
}

TEST(Textures, AreFunctionsOfNameAndSeed) {
  for (const auto& name : texture_names()) {
    const auto image = make_texture(name, 5);
    EXPECT_LE(std::max(image.width, image.height), 512) << name;
    EXPECT_EQ(image.pixels, make_texture(name, 5).pixels) << name;
    EXPECT_EQ(image.pixels == make_texture(name, 6).pixels, name == "blank") << name;
    EXPECT_GT(texture_period_m(name), 0.0);
  }
  EXPECT_THROW(make_texture("marble", 1), std::runtime_error);
  EXPECT_FALSE(is_texture("marble"));
}

TEST(Textures, OfWallsAndFloorsRepeatWithoutASeam) {
  for (const auto& name : texture_names()) {
    if (name == "outdoor" || name == "mirror" || name == "clutter") continue;  // shown once, or boxes anyway
    const auto image = make_texture(name, 2);
    double columns = 0.0, rows = 0.0;
    for (int i = 0; i < image.width; ++i) columns = std::max(columns, step_after(image, i));
    for (int i = 0; i < image.height; ++i) rows = std::max(rows, step_below(image, i));
    // The border is no sharper than the sharpest line inside by more than a little.
    double inner_columns = 0.0, inner_rows = 0.0;
    for (int i = 0; i + 1 < image.width; ++i) inner_columns = std::max(inner_columns, step_after(image, i));
    for (int i = 0; i + 1 < image.height; ++i) inner_rows = std::max(inner_rows, step_below(image, i));
    EXPECT_LE(columns, 1.25 * inner_columns + 0.5) << name;
    EXPECT_LE(rows, 1.25 * inner_rows + 0.5) << name;
  }
}

TEST(Textures, PlasterIsWeak) {
  const auto image = make_texture("plaster", 1);
  double sum = 0.0, squares = 0.0;
  for (const auto& pixel : image.pixels) {
    sum += pixel.g;
    squares += pixel.g * pixel.g;
  }
  const auto count = static_cast<double>(image.pixels.size());
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  EXPECT_GT(deviation / mean, 0.005);
  EXPECT_LT(deviation / mean, 0.03);
}

TEST(Textures, RichnessScalesContrast) {
  const auto flat = make_texture("planks", 1, 0.0);
  EXPECT_EQ(difference(flat, TextureImage(512, 512, flat(0, 0))), 0.0);
  EXPECT_GT(difference(make_texture("planks", 1, 1.0), flat), 5.0);
}

TEST(Textures, LibraryMakesEachOnce) {
  TextureLibrary library;
  EXPECT_EQ(library.surface("brick", 1), library.surface("brick", 1));
  EXPECT_NE(library.surface("brick", 1), library.surface("brick", 2));
  EXPECT_EQ(library.surface("brick", 1)->pixels, make_texture("brick", 1).pixels);
}

TEST(Pictures, NoTwoMotifsAreAlikeAndAllHaveCorners) {
  constexpr std::uint64_t kMotifs = 60;
  std::vector<TextureImage> pictures;
  for (std::uint64_t motif = 0; motif < kMotifs; ++motif) pictures.push_back(make_picture(motif, 4.0 / 3.0));
  for (std::uint64_t a = 0; a < kMotifs; ++a) {
    EXPECT_GT(corners(pictures[a]), 100) << "motif " << a;
    for (std::uint64_t b = a + 1; b < kMotifs; ++b)
      EXPECT_GT(difference(pictures[a], pictures[b]), 8.0) << "motifs " << a << " and " << b;
  }
}

TEST(Pictures, AreFunctionsOfTheMotifAndKeepTheAspect) {
  EXPECT_EQ(make_picture(3, 2.0).pixels, make_picture(3, 2.0).pixels);
  EXPECT_EQ(make_picture(3, 2.0).width, 256);
  EXPECT_EQ(make_picture(3, 2.0).height, 128);
  EXPECT_EQ(make_picture(3, 0.5).width, 128);
  const auto flat = make_picture(3, 1.0, 0.0);
  EXPECT_EQ(difference(flat, TextureImage(256, 256, flat(0, 0))), 0.0);
}

}  // namespace
}  // namespace lapis::simulator
