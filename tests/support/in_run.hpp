#pragma once

#include <cstdlib>

namespace lapis::test {

/// Processes and participants that start meanwhile belong to a run.
class InRun {
 public:
  explicit InRun(const char* run) { setenv("LAPIS_RUN", run, 1); }
  ~InRun() { unsetenv("LAPIS_RUN"); }
  InRun(const InRun&) = delete;
  InRun& operator=(const InRun&) = delete;
};

}  // namespace lapis::test
