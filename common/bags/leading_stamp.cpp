#include "common/bags/leading_stamp.hpp"

#include <cstddef>

namespace lapis::bags {
namespace {

constexpr std::size_t kEncapsulation = 4;  // of CDR
constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::uint32_t number_at(const std::vector<std::uint8_t>& cdr, std::size_t at, bool is_little) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t shift = 8 * (is_little ? i : 3 - i);
    number |= static_cast<std::uint32_t>(cdr[at + i]) << shift;
  }
  return number;
}

}  // namespace

std::optional<time::Time> leading_stamp(const std::vector<std::uint8_t>& cdr) {
  if (cdr.size() < kEncapsulation + 8 || cdr[0] != 0 || cdr[1] > 1) return std::nullopt;
  const bool is_little = cdr[1] == 1;
  const auto seconds = static_cast<std::int32_t>(number_at(cdr, kEncapsulation, is_little));
  const std::int64_t nanoseconds = number_at(cdr, kEncapsulation + 4, is_little);
  if (nanoseconds >= kSecond_ns) return std::nullopt;
  return time::Time{seconds * kSecond_ns + nanoseconds};
}

}  // namespace lapis::bags
