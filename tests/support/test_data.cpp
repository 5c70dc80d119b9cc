#include "tests/support/test_data.hpp"

#include <cstdlib>

namespace lapis::test {
namespace {

std::filesystem::path folder() {
  const char* given = std::getenv("LAPIS_TEST_DATA");  // NOLINT(concurrency-mt-unsafe): tests do not set it
  return given != nullptr ? given : LAPIS_DEFAULT_TEST_DATA;
}

}  // namespace

std::optional<std::filesystem::path> find_test_data(const std::string& part) {
  const auto path = folder() / part;
  return std::filesystem::exists(path) ? std::optional(path) : std::nullopt;
}

std::string missing_test_data(const std::string& part) {
  return "no recorded data at " + (folder() / part).string() + "; set LAPIS_TEST_DATA to the folder that has it";
}

}  // namespace lapis::test
