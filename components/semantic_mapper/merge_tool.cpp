#include "semantic_mapper/merge_tool.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "semantic_mapper/core/map_merge.hpp"
#include "semantic_mapper/tool_input.hpp"

namespace lapis::semantic_mapper {
namespace {

using geometry::Pose;

constexpr double kMaxDistance_m = 10'000.0;  // the same limit as for frames

struct MergeOptions {
  std::vector<std::string> files;
  std::vector<std::string> transforms;
  std::string out;
};

/// "X,Y,Z,ROLL,PITCH,YAW" in metres and degrees; rotations about the fixed axes x, then y, then z (REP 103).
Pose parse_transform(const std::string& text) {
  std::array<double, 6> v{};
  std::istringstream in(text);
  char comma = ',';
  for (std::size_t i = 0; i < v.size(); ++i)
    if ((i > 0 && !(in >> comma && comma == ',')) || !(in >> v[i])) in.setstate(std::ios::failbit);
  Pose T = Pose::Identity();
  const Eigen::Vector3d rad = Eigen::Vector3d(v[3], v[4], v[5]) * (M_PI / 180.0);
  T.linear() =
      (Eigen::AngleAxisd(rad.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rad.y(), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(rad.x(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  T.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  if (!in || !in.eof() || !geometry::is_valid(T) || T.translation().norm() > kMaxDistance_m)
    throw std::runtime_error("--transform '" + text +
                             "': expected X,Y,Z,ROLL,PITCH,YAW in metres (at most 10 km) and degrees");
  return T;
}

std::size_t frames_of(const mapping::MapFile& file) {
  const auto note = file.provenance.find("frames");
  return note == file.provenance.end() ? 0 : std::strtoull(note->second.c_str(), nullptr, 10);
}

void merge(const MergeOptions& options, std::ostream& out) {
  if (!options.transforms.empty() && options.transforms.size() + 1 != options.files.size())
    throw std::runtime_error("merge: give one --transform for each map after the first, or none");
  if (extension_of(options.out) != ".lapis")
    throw std::runtime_error("--out " + options.out + ": a merged map is a .lapis file; convert makes others of it");
  mapping::MapFile sum = read_map(options.files[0]);
  std::size_t frames = frames_of(sum);
  std::string sources = options.files[0];
  for (std::size_t i = 1; i < options.files.size(); ++i) {
    const std::string& name = options.files[i];
    const Pose T = options.transforms.empty() ? Pose::Identity() : parse_transform(options.transforms[i - 1]);
    const mapping::MapFile other = read_map(name);
    try {
      merge_into(sum, other, T);
    } catch (const std::exception& error) {
      throw std::runtime_error(name + ": " + error.what());
    }
    const bool is_exact = is_on_grid(T, sum.map.resolution_m());
    out << name
        << (is_exact ? ": added voxel by voxel" : ": resampled, because it is turned or shifted by parts of voxels")
        << '\n';
    frames += frames_of(other);
    sources += (is_exact ? " + " : " + resampled ") + name;
  }
  sum.provenance = {{"frames", std::to_string(frames)}, {"merged_from", sources}};
  if (const auto problem = mapping::save_map(options.out, sum)) throw std::runtime_error(*problem);
}

}  // namespace

void add_merge_tool(CLI::App& app, std::ostream& out) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App* tool = app.add_subcommand("merge", "merge maps whose relative poses are known, by adding their counts");
  tool->add_option("files", options->files,
                   "two or more .lapis maps of one resolution, in which an id means the same class")
      ->required()
      ->expected(2, 1000);
  tool->add_option("--out", options->out, "merged .lapis map to write")->required();
  tool->add_option(
          "--transform", options->transforms,
          "pose X,Y,Z,ROLL,PITCH,YAW of a map's frame in the frame of the first map [m, deg]; give one for each\n"
          "map after the first, in the order of the maps, or none when all maps have the same frame")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  tool->footer(
      "Transforms of quarter turns and whole numbers of voxels are exact: the result is the map that all frames\n"
      "together would have given. Any other transform resamples the map (nearest voxel), and surfaces move by up to\n"
      "half the diagonal of a voxel. The merged map has the sensor model of the first map. Example:\n"
      "  lapis_semantic_mapper merge a.lapis b.lapis --transform 4.5,-2,0,0,0,90 --out both.lapis");
  tool->callback([options, &out] { merge(*options, out); });
}

}  // namespace lapis::semantic_mapper
