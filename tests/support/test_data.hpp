#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lapis::test {

/// A file or folder of the recorded test data: below LAPIS_TEST_DATA, or below ../shared/data beside the repository
/// when the variable is not set. Nothing when it is not there: the test skips with `missing_test_data(part)`.
std::optional<std::filesystem::path> find_test_data(const std::string& part);

/// What is missing, where it was looked for, and the remedy.
std::string missing_test_data(const std::string& part);

}  // namespace lapis::test
