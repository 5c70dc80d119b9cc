#pragma once

#include <iosfwd>
#include <string_view>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls itself so
class App;
}

namespace lapis::runtime {

/// The file tools of an executable: subcommands that need no DDS.
struct FileTools {
  const char* executable;
  const char* summary;
  /// Adds the subcommands. They write their results to `out` and throw a std::exception whose text says in one line
  /// what the user has to correct.
  void (*add)(CLI::App& app, std::ostream& out);
};

/// True when `word`, the first argument of the executable, names one of its tools.
bool is_file_tool(const FileTools& tools, std::string_view word);

/// Runs the tool that the arguments name. Results go to `out`, messages go to `err`. Returns the exit status: 0, or 2
/// for wrong arguments and unusable files.
int run_file_tool(const FileTools& tools, int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace lapis::runtime
