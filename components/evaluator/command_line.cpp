#include "evaluator/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>

#include "evaluator/map_tools.hpp"
#include "evaluator/trajectory_tools.hpp"

namespace lapis::evaluator {
namespace {

constexpr int kBadSetup = 2;
constexpr std::array kFileTools = {"ate", "rpe", "map", "iou", "coverage"};

}  // namespace

bool is_file_tool(std::string_view word) {
  return std::find(kFileTools.begin(), kFileTools.end(), word) != kFileTools.end();
}

int run_file_tool(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  CLI::App app("Metrics on files: what a run of SLAM and mapping is worth", "lapis_evaluator");
  app.require_subcommand(1);
  add_ate_tool(app, out);
  add_rpe_tool(app, out);
  add_map_tools(app, out);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error, out, err) == 0 ? 0 : kBadSetup;
  } catch (const std::exception& error) {
    err << "lapis_evaluator: " << error.what() << '\n';
    return kBadSetup;
  }
}

}  // namespace lapis::evaluator
