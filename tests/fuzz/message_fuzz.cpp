// A sample of a topic: the first byte chooses the topic, the others are the bytes that a reader gets.

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/dds/type_support.hpp"
#include "message_types.hpp"
#include "tests/unit/idl/cdr.hpp"

namespace lapis::fuzz {
namespace {

using idl::test::Bytes;

/// What has been read can be written, and is read again as what was written. The first reading may differ: a string
/// ends at its first NUL when it is written. Bytes are compared, because a NaN is not equal to itself.
template <class Message>
void check(const Bytes& sample) {
  using Guarded = dds::GuardedType<typename idl::TypeSupport<Message>::PubSubType>;
  Message message, again;
  if (!idl::test::deserialize<Message, Guarded>(sample, message)) return;
  const Bytes written = idl::test::serialize(message);
  if (written.empty() || !idl::test::deserialize<Message, Guarded>(written, again)) std::abort();
  if (idl::test::serialize(again) != written) std::abort();
}

void check_sample(std::uint8_t topic, const Bytes& sample) {
  static const std::size_t count = message_count();
  const std::size_t chosen = topic % count;
  std::size_t number = 0;
  for_each_message([&]<class Message>(std::type_identity<Message>) {
    if (number++ == chosen) check<Message>(sample);
  });
}

}  // namespace
}  // namespace lapis::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1) lapis::fuzz::check_sample(data[0], {data + 1, data + size});
  return 0;
}
