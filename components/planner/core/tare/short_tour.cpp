#include "planner/core/tare/short_tour.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace lapis::planner {
namespace {

constexpr double kLeastGain = 1e-9;  // rounding must not lead to endless improvements

using Order = std::vector<int>;

std::ptrdiff_t size_of(const Order& order) { return static_cast<std::ptrdiff_t>(order.size()); }

double insertion_cost(const Eigen::MatrixXd& cost, const Order& order, std::size_t at, int node) {
  const double before = cost(order[at - 1], node);
  if (at == order.size()) return before;
  return before + cost(node, order[at]) - cost(order[at - 1], order[at]);
}

// Cheapest insertion: repeatedly inserts the node that lengthens the tour least, at the best position.
Order insert_all(const Eigen::MatrixXd& cost, bool ends_at_last) {
  const int nodes = static_cast<int>(cost.rows());
  Order order{0}, left;
  if (ends_at_last) order.push_back(nodes - 1);
  for (int node = 1; node < (ends_at_last ? nodes - 1 : nodes); ++node) left.push_back(node);
  while (!left.empty()) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0, place = 1;
    for (std::size_t i = 0; i < left.size(); ++i) {
      for (std::size_t at = 1; at < order.size() + (ends_at_last ? 0 : 1); ++at) {
        const double more = insertion_cost(cost, order, at, left[i]);
        if (more >= least) continue;
        least = more;
        best = i;
        place = at;
      }
    }
    order.insert(order.begin() + static_cast<std::ptrdiff_t>(place), left[best]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return order;
}

/// Makes the first change that shortens the tour, of reversals and moves in [1, end). Returns false when there is none.
bool improve(const Eigen::MatrixXd& cost, std::ptrdiff_t end, Order& order, double& length) {
  Order changed = order;
  const auto is_better = [&] {
    const double now = tour_length(cost, changed);
    if (now >= length - kLeastGain) return false;
    length = now;
    order = changed;
    return true;
  };
  for (std::ptrdiff_t i = 1; i < end; ++i) {
    for (std::ptrdiff_t j = i + 1; j < end; ++j) {
      const auto first = changed.begin() + i, last = changed.begin() + j + 1;
      std::reverse(first, last);
      if (is_better()) return true;
      std::reverse(first, last);
      std::rotate(first, first + 1, last);  // move the first node to the end
      if (is_better()) return true;
      std::rotate(first, last - 1, last);
      std::rotate(first, last - 1, last);  // move the last node to the beginning
      if (is_better()) return true;
      std::rotate(first, first + 1, last);
    }
  }
  return false;
}

}  // namespace

double tour_length(const Eigen::MatrixXd& cost, const std::vector<int>& order) {
  double length = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i) length += cost(order[i - 1], order[i]);
  return length;
}

std::vector<int> short_tour(const Eigen::MatrixXd& cost, bool ends_at_last) {
  Order order = insert_all(cost, ends_at_last);
  double length = tour_length(cost, order);
  const std::ptrdiff_t end = size_of(order) - (ends_at_last ? 1 : 0);
  while (improve(cost, end, order, length)) continue;
  return order;
}

}  // namespace lapis::planner
