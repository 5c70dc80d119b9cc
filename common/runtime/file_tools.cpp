#include "common/runtime/file_tools.hpp"

#include <CLI/CLI.hpp>

#include <ostream>

namespace lapis::runtime {
namespace {

constexpr int kBadSetup = 2;

}  // namespace

bool is_file_tool(const FileTools& tools, std::string_view word) {
  CLI::App app;
  std::ostream nowhere(nullptr);
  tools.add(app, nowhere);
  return !app.get_subcommands([word](const CLI::App* tool) { return tool->get_name() == word; }).empty();
}

int run_file_tool(const FileTools& tools, int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  CLI::App app(tools.summary, tools.executable);
  app.require_subcommand(1);
  tools.add(app, out);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error, out, err) == 0 ? 0 : kBadSetup;
  } catch (const std::exception& error) {
    err << tools.executable << ": " << error.what() << '\n';
    return kBadSetup;
  }
}

}  // namespace lapis::runtime
