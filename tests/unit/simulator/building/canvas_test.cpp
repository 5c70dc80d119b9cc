#include "simulator/core/looks/canvas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lapis::simulator {
namespace {

double share_of(const Canvas& canvas, const Paint& paint) {
  int count = 0;
  for (int row = 0; row < canvas.height(); ++row) {
    for (int column = 0; column < canvas.width(); ++column) count += canvas(column, row) == paint ? 1 : 0;
  }
  return static_cast<double>(count) / (canvas.width() * canvas.height());
}

TEST(Canvas, ShapesCoverTheirArea) {
  const Paint ground = Paint::Zero(), ink = Paint::Ones();
  Canvas a(400, 200, ground), b(400, 200, ground), c(400, 200, ground), d(400, 200, ground);
  a.rectangle({0.1, 0.2, 0.6, 0.5, ink});
  EXPECT_NEAR(share_of(a, ink), 0.15, 1e-3);
  b.ellipse({0.5, 0.5, 0.2, 0.3, ink});
  EXPECT_NEAR(share_of(b, ink), std::numbers::pi * 0.06, 2e-3);
  c.triangle({{0.1, 0.1}, {0.9, 0.1}, {0.1, 0.9}, ink});
  EXPECT_NEAR(share_of(c, ink), 0.32, 5e-3);
  // A slanting line in units of the height: 2 wide, length from (0.2, 0.2) to (1.8, 0.8), with two round ends.
  d.line({0.1, 0.2, 0.9, 0.8, 0.04, ink});
  EXPECT_NEAR(share_of(d, ink), (std::hypot(1.6, 0.6) * 0.04 + std::numbers::pi * 0.02 * 0.02) / 2.0, 1e-3);
}

TEST(Canvas, NothingIsPaintedOutside) {
  Canvas canvas(8, 8, Paint::Zero());
  canvas.rectangle({-1, -1, 2, 2, Paint::Ones()});
  canvas.ellipse({1.5, 1.5, 0.2, 0.2, Paint::Constant(0.5F)});
  EXPECT_EQ(share_of(canvas, Paint::Ones()), 1.0);
}

TEST(Canvas, HsvHasTheCornersOfTheColourCube) {
  EXPECT_TRUE(hsv({0.0, 1.0, 1.0}).isApprox(Paint(1, 0, 0)));
  EXPECT_TRUE(hsv({1.0 / 3.0, 1.0, 1.0}).isApprox(Paint(0, 1, 0), 1e-5F));
  EXPECT_TRUE(hsv({2.0 / 3.0, 1.0, 0.5}).isApprox(Paint(0, 0, 0.5F), 1e-5F));
  EXPECT_TRUE(hsv({-0.7, 0.6, 0.8}).isApprox(hsv({0.3, 0.6, 0.8}), 1e-5F));
}

TEST(Canvas, NoiseRepeats) {
  const TiledNoise noise(Random(3, RandomStream::kTexture), 7);
  for (float u = 0.01F; u < 1.0F; u += 0.09F) {
    EXPECT_NEAR(noise.at(u, 0.3F), noise.at(u + 1.0F, 0.3F - 1.0F), 1e-4F);
    EXPECT_NEAR(noise.at(u, 0.0F), noise.at(u, 1.0F), 1e-4F);
  }
}

TEST(Canvas, ContrastScalesAboutTheMean) {
  Canvas canvas(10, 10, Paint::Constant(0.4F));
  canvas.rectangle({0, 0, 1, 0.5, Paint::Constant(0.6F)});
  const auto flat = canvas.image(0.0), doubled = canvas.image(2.0);
  EXPECT_EQ(flat(0, 0), flat(0, 9));
  EXPECT_NEAR(flat(0, 0).r, 127.5, 1.0);
  EXPECT_NEAR(doubled(0, 0).g - doubled(0, 9).g, 0.4 * 255, 1.5);
}

}  // namespace
}  // namespace lapis::simulator
