#include <unistd.h>

#include <cstdio>
#include <exception>

#include "tests/support/private_domain.hpp"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "use: lapis_in_private_domain COMMAND [ARGUMENT]...\n");
    return 2;
  }
  try {
    std::fprintf(stderr, "%s\n", lapis::test::enter_private_domain().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lapis_in_private_domain: %s\n", error.what());
    return 2;
  }
  execvp(argv[1], argv + 1);
  std::perror(argv[1]);
  return 2;
}
