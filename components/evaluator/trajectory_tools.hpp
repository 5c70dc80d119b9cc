#pragma once

#include <CLI/CLI.hpp>
#include <iosfwd>

namespace lapis::evaluator {

/// Adds the tool `ate`: absolute trajectory error of one TUM file against another.
void add_ate_tool(CLI::App& app, std::ostream& out);
/// Adds the tool `rpe`: relative pose error of one TUM file against another.
void add_rpe_tool(CLI::App& app, std::ostream& out);

}  // namespace lapis::evaluator
