#include "evaluator/command_line.hpp"

#include <CLI/CLI.hpp>

#include "evaluator/map_tools.hpp"
#include "evaluator/trajectory_tools.hpp"

namespace lapis::evaluator {

void add_file_tools(CLI::App& app, std::ostream& out) {
  add_ate_tool(app, out);
  add_rpe_tool(app, out);
  add_map_tools(app, out);
}

}  // namespace lapis::evaluator
