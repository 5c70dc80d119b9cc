#include "message_seeds.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "message_types.hpp"
#include "tests/unit/idl/cdr.hpp"

namespace lapis::fuzz {
namespace {

using idl::test::Bytes;

/// Bytes in which every count and every length is 1 and every boolean is valid, whatever the type.
Bytes ones() {
  constexpr std::size_t kWords = 2000;  // more than any type takes
  Bytes bytes{0, 1, 0, 0};
  for (std::size_t i = 0; i < kWords; ++i) bytes.insert(bytes.end(), {1, 0, 0, 0});
  return bytes;
}

}  // namespace

std::vector<Bytes> message_seeds() {
  std::vector<Bytes> seeds;
  std::uint8_t number = 0;
  for_each_message([&]<class Message>(std::type_identity<Message>) {
    Message empty, filled;
    if (!idl::test::deserialize(ones(), filled)) {
      throw std::logic_error(std::string(idl::TypeSupport<Message>::kRosName) + " needs more bytes");
    }
    for (const Message& message : {empty, filled}) {
      Bytes seed = idl::test::serialize(message);
      seed.insert(seed.begin(), number);
      seeds.push_back(std::move(seed));
    }
    ++number;
  });
  return seeds;
}

}  // namespace lapis::fuzz
