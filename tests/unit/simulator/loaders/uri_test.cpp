#include "simulator/core/loaders/uri.hpp"

#include <gtest/gtest.h>

namespace lapis::simulator {
namespace {

std::string decoded(std::string_view uri) {
  const auto bytes = decode_data_uri(uri);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "none";
}

TEST(Uri, DecodesTheExamplesOfRfc4648) {
  const std::string head = "data:application/octet-stream;base64,";
  EXPECT_EQ(decoded(head), "");
  EXPECT_EQ(decoded(head + "Zg=="), "f");
  EXPECT_EQ(decoded(head + "Zm8="), "fo");
  EXPECT_EQ(decoded(head + "Zm9vYmFy"), "foobar");
}

TEST(Uri, OtherAddressesHoldNoData) {
  EXPECT_EQ(decoded("house.bin"), "none");
  EXPECT_EQ(decoded("data:text/plain,abc"), "none");
  EXPECT_EQ(decoded("data:x;base64,Zm9*"), "none");
}

TEST(Uri, DecodesPercentSigns) {
  EXPECT_EQ(decode_percent("a%20b%2Fc"), "a b/c");
  EXPECT_EQ(decode_percent("100%"), "100%");
  EXPECT_EQ(decode_percent("%4"), "%4");
  EXPECT_EQ(decode_percent("%zz%41"), "%zzA");
}

}  // namespace
}  // namespace lapis::simulator
