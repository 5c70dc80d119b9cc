#include "planner/core/tare/short_tour.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

Eigen::MatrixXd distances(const Eigen::Matrix2Xd& points) {
  Eigen::MatrixXd cost(points.cols(), points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index j = 0; j < points.cols(); ++j) cost(i, j) = (points.col(i) - points.col(j)).norm();
  return cost;
}

Eigen::Matrix2Xd random_points(int count, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> in_room(0.0, 10.0);
  return Eigen::Matrix2Xd::NullaryExpr(2, count, [&] { return in_room(engine); });
}

std::vector<int> first_to_last(int count) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// By trying all orders.
double shortest(const Eigen::MatrixXd& cost, bool ends_at_last) {
  std::vector<int> order = first_to_last(static_cast<int>(cost.rows()));
  double least = tour_length(cost, order);
  while (std::next_permutation(order.begin() + 1, order.end() - (ends_at_last ? 1 : 0)))
    least = std::min(least, tour_length(cost, order));
  return least;
}

TEST(ShortTour, OfPointsOnALineIsTheLine) {
  Eigen::Matrix2Xd points = Eigen::Matrix2Xd::Zero(2, 6);
  points.row(0) << 0, 4, 2, 5, 1, 3;
  EXPECT_EQ(short_tour(distances(points), false), (std::vector<int>{0, 4, 2, 5, 1, 3}));
}

TEST(ShortTour, VisitsEachOnceAndKeepsItsEnds) {
  for (const int count : {2, 3, 10, 40}) {
    for (const bool ends_at_last : {false, true}) {
      std::vector<int> order = short_tour(distances(random_points(count, 5)), ends_at_last);
      EXPECT_EQ(order.front(), 0);
      if (ends_at_last) {
        EXPECT_EQ(order.back(), count - 1);
      }
      std::sort(order.begin(), order.end());
      EXPECT_EQ(order, first_to_last(count));
    }
  }
}

TEST(ShortTour, IsNearTheShortest) {
  double sum = 0.0, best = 0.0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Eigen::MatrixXd cost = distances(random_points(8, seed));
    const bool ends_at_last = seed % 2 == 0;
    const double length = tour_length(cost, short_tour(cost, ends_at_last)), least = shortest(cost, ends_at_last);
    EXPECT_GE(length, least - 1e-9);
    EXPECT_LE(length, 1.15 * least) << seed;
    sum += length;
    best += least;
  }
  EXPECT_LE(sum, 1.02 * best);
}

TEST(ShortTour, IsMuchShorterThanARandomOrder) {
  const Eigen::MatrixXd cost = distances(random_points(40, 1));
  EXPECT_LT(tour_length(cost, short_tour(cost, false)), 0.4 * tour_length(cost, first_to_last(40)));
}

}  // namespace
}  // namespace lapis::planner
