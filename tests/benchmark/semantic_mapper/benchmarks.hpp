#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

namespace lapis::semantic_mapper::benchmarks {

/// CPU time of this thread [s].
inline double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Work>
double cpu_s_of(Work&& work) {
  const double begin_s = cpu_s();
  work();
  return cpu_s() - begin_s;
}

inline double quantile_ms(std::vector<double> seconds, double share) {
  const auto at = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(seconds.size() - 1)));
  std::nth_element(seconds.begin(), seconds.begin() + at, seconds.end());
  return seconds[static_cast<std::size_t>(at)] * 1e3;
}

inline double ratio(std::size_t a, std::size_t b) { return static_cast<double>(a) / static_cast<double>(b); }

/// Frames into the map, beside OctoMap.
void register_insert();
/// Frames that follow the pose graph, and the obstacle layer, on a tour of large_building.
void register_corrections();

}  // namespace lapis::semantic_mapper::benchmarks
