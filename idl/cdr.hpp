#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

// XCDR1 plain CDR [OMG DDSI-RTPS 10, CORBA 15.3], the bytes of ROS 2's messages. Generated types call CdrWriter and
// CdrReader member by member; encode() and decode() add what stands before a message, its encapsulation.

namespace lapis::idl {

static_assert(std::endian::native == std::endian::little, "messages are copied as they lie in memory");

template <class T>
concept CdrNumber = std::is_arithmetic_v<T>;

/// Number of bytes between `at` and the next multiple of `size`, a power of two.
constexpr std::size_t cdr_padding(std::size_t at, std::size_t size) { return (size - at % size) % size; }

/// Writes into given memory; without memory it counts the bytes only.
class CdrWriter {
 public:
  CdrWriter() = default;
  explicit CdrWriter(std::span<std::uint8_t> memory, std::endian order = std::endian::little)
      : memory_(memory), is_swapped_(order != std::endian::native) {}

  /// Bytes so far, also those that did not fit.
  std::size_t size() const { return at_; }

  template <CdrNumber T>
  void operator()(T value) {
    align(sizeof(T));
    std::array<std::uint8_t, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    put(bytes.data(), bytes.size());
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size() + 1));
    put(text.c_str(), text.size() + 1);
  }
  template <class T>
  void operator()(const std::vector<T>& elements) {
    (*this)(static_cast<std::uint32_t>(elements.size()));
    put_elements(elements);
  }
  template <class T, std::size_t kSize>
  void operator()(const std::array<T, kSize>& elements) {
    put_elements(elements);
  }
  template <class Message>
    requires std::is_class_v<Message>
  void operator()(const Message& message) {
    message.write(*this);
  }

 private:
  template <class Elements>
  void put_elements(const Elements& elements) {
    using Element = typename Elements::value_type;
    if constexpr (CdrNumber<Element> && !std::is_same_v<Element, bool>) {
      if (!is_swapped_ && !elements.empty()) {
        align(sizeof(Element));
        return put(elements.data(), elements.size() * sizeof(Element));
      }
    }
    for (const auto& element : elements) (*this)(static_cast<const Element&>(element));
  }
  void align(std::size_t size) {
    static constexpr std::array<std::uint8_t, 8> kZeros{};
    put(kZeros.data(), cdr_padding(at_, size));
  }
  void put(const void* bytes, std::size_t count) {
    if (count <= memory_.size() - std::min(at_, memory_.size()) && count > 0)
      std::memcpy(memory_.data() + at_, bytes, count);
    at_ += count;
  }

  std::span<std::uint8_t> memory_;
  std::size_t at_ = 0;
  bool is_swapped_ = false;
};

/// Reads bytes that anybody may have sent. After a fault nothing more is read, and is_good() is false.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> bytes, std::endian order = std::endian::little)
      : bytes_(bytes), is_swapped_(order != std::endian::native) {}

  bool is_good() const { return is_good_; }

  template <CdrNumber T>
  void operator()(T& value) {
    std::array<std::uint8_t, sizeof(T)> bytes;
    if (!align(sizeof(T)) || !take(bytes.data(), bytes.size())) return;
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    if constexpr (std::is_same_v<T, bool>) {
      if (bytes[0] > 1) return fail();
      value = bytes[0] == 1;
    } else {
      std::memcpy(&value, bytes.data(), sizeof(T));
    }
  }
  /// `bound`: greatest length that the type allows.
  void operator()(std::string& text, std::size_t bound = std::numeric_limits<std::uint32_t>::max()) {
    std::uint32_t size = 0;
    (*this)(size);
    if (size > left()) return fail();
    const auto* first = reinterpret_cast<const char*>(bytes_.data() + at_);
    at_ += size;
    if (size > 0 && first[size - 1] == '\0') --size;  // the NUL is no part of the text
    if (size > bound) return fail();
    text.assign(first, size);
  }
  template <class T>
  void operator()(std::vector<T>& elements, std::size_t bound = std::numeric_limits<std::uint32_t>::max()) {
    std::uint32_t count = 0;
    (*this)(count);
    if (count > bound || count > left()) return fail();  // an element takes at least one byte
    if constexpr (CdrNumber<T> && !std::is_same_v<T, bool>) {
      if (count > 0 && (!align(sizeof(T)) || count > left() / sizeof(T))) return fail();
      elements.resize(count);
      take_elements(elements);
    } else {
      // Grows with what is really there: a count alone allocates nothing.
      elements.clear();
      while (is_good_ && elements.size() < count) {
        T element{};
        (*this)(element);
        elements.push_back(std::move(element));
      }
    }
  }
  template <class T, std::size_t kSize>
  void operator()(std::array<T, kSize>& elements) {
    take_elements(elements);
  }
  template <class Message>
    requires std::is_class_v<Message>
  void operator()(Message& message) {
    message.read(*this);
  }

 private:
  template <class Elements>
  void take_elements(Elements& elements) {
    using Element = typename Elements::value_type;
    if constexpr (CdrNumber<Element> && !std::is_same_v<Element, bool>) {
      if (!is_swapped_ && !elements.empty()) {
        if (align(sizeof(Element))) take(elements.data(), elements.size() * sizeof(Element));
        return;
      }
    }
    for (auto& element : elements) (*this)(element);
  }
  std::size_t left() const { return bytes_.size() - at_; }
  void fail() {
    is_good_ = false;
    at_ = bytes_.size();
  }
  bool align(std::size_t size) {
    const std::size_t padding = cdr_padding(at_, size);
    if (padding > left()) fail();
    if (is_good_) at_ += padding;
    return is_good_;
  }
  bool take(void* to, std::size_t count) {
    if (count > left()) fail();
    if (!is_good_) return false;
    std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
    return true;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool is_swapped_ = false;
  bool is_good_ = true;
};

/// What stands before a message: kind of encoding (plain CDR and its byte order) and options, which are 0.
inline constexpr std::size_t kEncapsulationBytes = 4;
inline constexpr std::array<std::uint8_t, kEncapsulationBytes> kLittleEndianCdr{0, 1, 0, 0};

/// Size of a message on the wire.
template <class Message>
std::size_t encoded_bytes(const Message& message) {
  CdrWriter counter;
  message.write(counter);
  return kEncapsulationBytes + counter.size();
}

/// Writes a message into memory of at least encoded_bytes(); the number of bytes written, 0 when they do not fit.
template <class Message>
std::size_t encode(const Message& message, std::span<std::uint8_t> to) {
  if (to.size() < kEncapsulationBytes) return 0;
  std::copy(kLittleEndianCdr.begin(), kLittleEndianCdr.end(), to.begin());
  CdrWriter writer(to.subspan(kEncapsulationBytes));
  message.write(writer);
  const std::size_t size = kEncapsulationBytes + writer.size();
  return size <= to.size() ? size : 0;
}

/// Reads a message; false when the bytes are none, and `message` holds what was read until then. Bytes that follow the
/// message are its padding.
template <class Message>
bool decode(std::span<const std::uint8_t> bytes, Message& message) {
  if (bytes.size() < kEncapsulationBytes || bytes[0] != 0 || bytes[1] > 1) return false;
  CdrReader reader(bytes.subspan(kEncapsulationBytes), bytes[1] == 0 ? std::endian::big : std::endian::little);
  message.read(reader);
  return reader.is_good();
}

}  // namespace lapis::idl
