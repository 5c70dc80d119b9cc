#include "semantic_mapper/file_tools.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <ostream>

#include "semantic_mapper/convert_tool.hpp"
#include "semantic_mapper/info_tool.hpp"
#include "semantic_mapper/merge_tool.hpp"

namespace lapis::semantic_mapper {
namespace {

constexpr int kBadSetup = 2;
constexpr std::array kFileTools = {"convert", "info", "merge"};

}  // namespace

bool is_file_tool(std::string_view word) {
  return std::find(kFileTools.begin(), kFileTools.end(), word) != kFileTools.end();
}

int run_file_tool(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  CLI::App app("Semantic mapping: tools on files", "lapis_semantic_mapper");
  app.require_subcommand(1);
  add_convert_tool(app);
  add_info_tool(app, out);
  add_merge_tool(app, out);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error, out, err) == 0 ? 0 : kBadSetup;
  } catch (const std::exception& error) {
    err << "lapis_semantic_mapper: " << error.what() << '\n';
    return kBadSetup;
  }
}

}  // namespace lapis::semantic_mapper
