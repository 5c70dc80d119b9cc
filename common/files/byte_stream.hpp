#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lapis::files {

/// Appends little-endian numbers and variable-length integers (seven bits a byte, low bits first) to a buffer.
class ByteWriter {
 public:
  /// Reserves memory for `more` further bytes.
  void reserve(std::size_t more) { bytes_.reserve(bytes_.size() + more); }
  void u8(std::uint8_t v) { bytes_.push_back(v); }
  void u16(std::uint16_t v) { fixed(v, 2); }
  void u32(std::uint32_t v) { fixed(v, 4); }
  void u64(std::uint64_t v) { fixed(v, 8); }
  void i32(std::int32_t v) { u32(static_cast<std::uint32_t>(v)); }
  void f32(float v) { u32(std::bit_cast<std::uint32_t>(v)); }
  void f64(double v) { u64(std::bit_cast<std::uint64_t>(v)); }
  void varint(std::uint64_t v) {
    for (; v >= 0x80; v >>= 7) u8(static_cast<std::uint8_t>(v | 0x80));
    u8(static_cast<std::uint8_t>(v));
  }
  /// Writes the length as a varint, then the characters.
  void text(std::string_view s) {
    varint(s.size());
    bytes_.insert(bytes_.end(), s.begin(), s.end());
  }
  void raw(std::span<const std::uint8_t> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }

  /// Overwrites an earlier number at byte offset `at`.
  void set_u32(std::size_t at, std::uint32_t v) { set(at, v, 4); }
  void set_u64(std::size_t at, std::uint64_t v) { set(at, v, 8); }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void fixed(std::uint64_t v, std::size_t size) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + size);
    set(at, v, size);
  }
  void set(std::size_t at, std::uint64_t v, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes_[at + i] = static_cast<std::uint8_t>(v >> (8 * i));
  }
  std::vector<std::uint8_t> bytes_;
};

/// Reads what ByteWriter wrote. Reading past the end or reading a malformed number gives zero and makes is_good() false
/// from then on, so that a decoder may check once per record instead of once per number.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool is_good() const { return is_good_; }
  std::size_t remaining() const { return bytes_.size(); }
  void fail() {
    is_good_ = false;
    bytes_ = {};
  }

  std::uint8_t u8() { return static_cast<std::uint8_t>(fixed(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(fixed(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(fixed(4)); }
  std::uint64_t u64() { return fixed(8); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  std::uint64_t varint() {
    if (!bytes_.empty() && bytes_[0] < 0x80) {  // most numbers are small
      const std::uint64_t v = bytes_[0];
      bytes_ = bytes_.subspan(1);
      return v;
    }
    std::uint64_t v = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = u8();
      const std::uint64_t part = static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (part >> shift != (byte & 0x7fu)) break;
      v |= part;
      if ((byte & 0x80) == 0) return v;
    }
    fail();
    return 0;
  }
  std::string text() {
    const std::span<const std::uint8_t> part = raw(varint());
    return {part.begin(), part.end()};
  }
  std::span<const std::uint8_t> raw(std::uint64_t size) {
    if (size > bytes_.size()) {
      fail();
      return {};
    }
    const auto part = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return part;
  }

 private:
  std::uint64_t fixed(std::size_t size) {
    std::uint64_t v = 0;
    const auto part = raw(size);
    for (std::size_t i = 0; i < part.size(); ++i) v |= static_cast<std::uint64_t>(part[i]) << (8 * i);
    return v;
  }
  std::span<const std::uint8_t> bytes_;
  bool is_good_ = true;
};

}  // namespace lapis::files
