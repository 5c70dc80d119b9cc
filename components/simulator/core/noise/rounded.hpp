#pragma once

namespace lapis::simulator {

/// Nearest integer, for -1000 < x < 1e5; faster than std::lround.
inline int rounded(float x) { return static_cast<int>(x + 1000.5F) - 1000; }

}  // namespace lapis::simulator
