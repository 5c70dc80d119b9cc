#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/private_domain.hpp"

int main(int argc, char** argv) {
  std::printf("%s\n", lapis::test::enter_private_domain().c_str());
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
