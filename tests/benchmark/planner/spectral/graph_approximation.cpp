// D of the weighted Laplacian beside that of the whole information matrix, on recorded graphs: the paper's central
// approximation. Prints a table, and writes every value to a CSV file for graph_approximation_figure.py.

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "slam/core/files/pose_graph_file.hpp"
#include "tests/unit/planner/spectral/full_information.hpp"

namespace lapis::planner {
namespace {

slam::PoseGraphSnapshot read(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + " cannot be read");
  auto result = slam::read_g2o(stream);
  if (const auto* error = std::get_if<slam::PoseGraphFileError>(&result))
    throw std::runtime_error(file + ": " + error->message);
  return std::get<slam::PoseGraphSnapshot>(std::move(result));
}

void write(std::ofstream& csv, const std::string& graph, const char* what,
           const std::vector<test::LogDeterminants>& values) {
  for (const auto& value : values) csv << graph << ',' << what << ',' << value.laplacian << ',' << value.full << '\n';
}

/// The name of a graph: that of its folder when the file is called as in every run.
std::string name_of(const std::filesystem::path& file) {
  return file.stem() == "pose_graph" ? file.parent_path().filename().string() : file.stem().string();
}

void compare(const std::string& file, std::ofstream& csv) {
  const auto comparison = test::compare_with_full_information(read(file));
  write(csv, name_of(file), "growth", comparison.growth);
  write(csv, name_of(file), "loop", comparison.loops);
  std::vector<double> ratios;
  for (const auto& loop : comparison.loops) ratios.push_back(loop.full / loop.laplacian);
  std::sort(ratios.begin(), ratios.end());
  std::printf("| %s | %d | %zu | %.3f | %.3f | %.2f |\n", name_of(file).c_str(), comparison.nodes,
              comparison.loops.size(), rank_correlation(comparison.loops), rank_correlation(comparison.growth),
              ratios.empty() ? 0.0 : ratios[ratios.size() / 2]);
}

int run(int argc, char** argv) {
  std::vector<std::string> files;
  std::string csv_file;
  CLI::App app("What loops and growth are worth by the Laplacian of a pose graph and by its whole information matrix");
  app.add_option("graphs", files, "g2o files")->required();
  app.add_option("--csv", csv_file, "every value");
  CLI11_PARSE(app, argc, argv);
  std::ofstream csv;
  if (!csv_file.empty()) {
    csv.open(csv_file);
    csv << "graph,what,laplacian,full\n";
  }
  std::printf(
      "| graph | key-frames | loops | Spearman over loops | over growth | full over Laplacian, median of loops |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  bool are_complete = true;
  for (const std::string& file : files) {
    try {
      compare(file, csv);
    } catch (const std::exception& error) {
      std::printf("| %s | %s | | | | |\n", name_of(file).c_str(), error.what());
      are_complete = false;
    }
  }
  if (!csv_file.empty() && !csv.flush()) throw std::runtime_error(csv_file + " cannot be written");
  return are_complete ? 0 : 1;
}

}  // namespace
}  // namespace lapis::planner

int main(int argc, char** argv) {
  try {
    return lapis::planner::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
