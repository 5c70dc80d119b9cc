#pragma once

#include <exception>
#include <string>

namespace lapis::segmenter::test {

/// Message of the std::exception that `action` throws; empty when it throws none.
template <class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace lapis::segmenter::test
