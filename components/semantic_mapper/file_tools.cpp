#include "semantic_mapper/file_tools.hpp"

#include <CLI/CLI.hpp>

#include "semantic_mapper/convert_tool.hpp"
#include "semantic_mapper/info_tool.hpp"
#include "semantic_mapper/merge_tool.hpp"

namespace lapis::semantic_mapper {

void add_file_tools(CLI::App& app, std::ostream& out) {
  add_convert_tool(app);
  add_info_tool(app, out);
  add_merge_tool(app, out);
}

}  // namespace lapis::semantic_mapper
