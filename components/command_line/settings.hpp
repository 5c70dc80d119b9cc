#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls itself so
class App;
}

namespace lapis::command_line {

/// Exit status of lapis; README.md has the same table.
enum Status : int {
  kDone = 0,
  kRefused = 1,    ///< the answer is no: a service or parameter refused, or doctor has found something
  kWrongCall = 2,  ///< an option, a name or a request that makes no sense, or DDS cannot start
  kNotThere = 3,   ///< no such topic, service or node in the domain
  kTooLate = 4     ///< it is there, but no message or answer came in time
};

/// Ends the program with a status and a line that says why and what to do.
class Failure : public std::runtime_error {
 public:
  Failure(Status status, const std::string& line) : std::runtime_error(line), status_(status) {}
  Status status() const { return status_; }

 private:
  Status status_;
};

/// Options of all commands.
struct Settings {
  std::optional<int> domain;
  std::string name_space;
  std::vector<std::string> remaps;
  double wait_s = 5.0;
  bool is_json = false;
  int socket_buffer_bytes = 4 << 20;
};

/// What the chosen command does; returns the exit status.
using Job = std::function<Status()>;

}  // namespace lapis::command_line
