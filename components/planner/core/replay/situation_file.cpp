#include "planner/core/replay/situation_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"

namespace lapis::planner {
namespace {

constexpr std::string_view kMagic = "LAPISSIT";
constexpr std::uint32_t kFormatVersion = 1;
constexpr double kFarthest_m = 20'000.0;  // of a pose from the origin; conversions.hpp refuses poses beyond 10 km
// Of a cell from the origin, along an axis: kMaxReach_m in the smallest voxels, and the cell that ends there.
constexpr auto kFarthestCell = static_cast<std::int32_t>(kMaxReach_m / mapping::kMinResolution_m) + 1;
constexpr int kMostDimensions = 6;  // of the information of an edge
constexpr double kRounding = 1e-6;  // tolerance for rotation matrices

/// Writes the parts that the functions below list.
struct Encoder {
  void number(double value) { out.f64(value); }
  void any_number(double value) { out.f64(value); }
  void whole(std::uint64_t value) { out.u64(value); }
  void whole(std::int64_t value) { out.u64(static_cast<std::uint64_t>(value)); }
  void whole(std::uint32_t value) { out.u32(value); }
  void whole(std::int32_t value) { out.i32(value); }
  void flag(bool value) { out.u8(value ? 1 : 0); }
  template <class Items, class Each>
  void list(const Items& items, const Each& each) {
    out.varint(items.size());
    for (const auto& item : items) each(*this, item);
  }
  template <class Value, class Each>
  void maybe(const std::optional<Value>& value, const Each& each) {
    flag(value.has_value());
    if (value) each(*this, *value);
  }
  void require(bool) {}

  files::ByteWriter out;
};

/// Reads the same parts; fails for numbers that are not finite.
struct Decoder {
  void number(double& value) {
    value = in.f64();
    require(std::isfinite(value));
  }
  void any_number(double& value) { value = in.f64(); }
  void whole(std::uint64_t& value) { value = in.u64(); }
  void whole(std::int64_t& value) { value = static_cast<std::int64_t>(in.u64()); }
  void whole(std::uint32_t& value) { value = in.u32(); }
  void whole(std::int32_t& value) { value = in.i32(); }
  void flag(bool& value) { value = in.u8() != 0; }
  template <class Items, class Each>
  void list(Items& items, const Each& each) {
    const std::uint64_t count = in.varint();
    require(count <= in.remaining());  // an item has at least one byte
    for (std::uint64_t i = 0; i < count && in.is_good(); ++i) each(*this, items.emplace_back());
  }
  template <class Value, class Each>
  void maybe(std::optional<Value>& value, const Each& each) {
    bool is_there = false;
    flag(is_there);
    if (is_there) each(*this, value.emplace());
  }
  void require(bool is_met) {
    if (!is_met) in.fail();
  }

  files::ByteReader in;
};

// Each of these functions lists the parts of its type once, for both directions.

constexpr auto kNumbers = [](auto& file, auto& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) file.number(matrix.data()[i]);
};

constexpr auto kCell = [](auto& file, auto& cell) {
  file.whole(cell.x);
  file.whole(cell.y);
  file.require(std::abs(std::int64_t{cell.x}) <= kFarthestCell && std::abs(std::int64_t{cell.y}) <= kFarthestCell);
};

constexpr auto kPose = [](auto& file, auto& pose) {
  kNumbers(file, pose.p_map);
  file.number(pose.yaw_rad);
  file.require(pose.p_map.norm() <= kFarthest_m);
};

constexpr auto kLeftAlone = [](auto& file, auto& place) {
  kNumbers(file, place.target_map);
  auto reason = static_cast<std::int32_t>(place.reason);
  file.whole(reason);
  file.require(reason >= 0 && reason <= static_cast<std::int32_t>(Rejection::kBesideStop));
  if constexpr (requires { place.reason = Rejection::kNone; }) place.reason = static_cast<Rejection>(reason);
  file.maybe(place.side_map, kNumbers);
};

constexpr auto kFailedView = [](auto& file, auto& view) {
  kNumbers(file, view.target_map);
  kNumbers(file, view.from_map);
};

constexpr auto kAdrift = [](auto& file, auto& adrift) {
  file.any_number(adrift.sigma_m);
  file.any_number(adrift.growth);
  file.number(adrift.budget_m);
  file.list(adrift.tracked, kPose);
};

constexpr auto kMemory = [](auto& file, auto& memory) {
  file.list(memory.left_alone, kLeftAlone);
  file.list(memory.old_places, kLeftAlone);
  file.list(memory.gap_places, kLeftAlone);
  file.list(memory.failed_views, kFailedView);
  file.list(memory.taken_views, kPose);
  file.flag(memory.looks_at_gaps);
  file.number(memory.radius_m);
  file.maybe(memory.goal, kPose);
  file.whole(memory.turns_to);
  file.maybe(memory.adrift, kAdrift);
};

constexpr auto kKeyframe = [](auto& file, auto& keyframe) {
  file.whole(keyframe.id);
  kNumbers(file, keyframe.T_map_camera.matrix());
  file.require(keyframe.T_map_camera.linear().isUnitary(kRounding) &&
               keyframe.T_map_camera.translation().norm() <= kFarthest_m);
};

constexpr auto kEdge = [](auto& file, auto& edge) {
  file.whole(edge.from);
  file.whole(edge.to);
  file.flag(edge.is_loop_closure);
  auto size = static_cast<std::int32_t>(edge.information.rows());
  file.whole(size);
  file.require(size >= 0 && size <= kMostDimensions);
  size = std::clamp(size, 0, kMostDimensions);
  if constexpr (requires { edge.from = 0; }) edge.information.resize(size, size);
  kNumbers(file, edge.information);
};

constexpr auto kWhole = [](auto& file, auto& value) { file.whole(value); };

constexpr auto kPoint = [](auto& file, auto& point) {
  Eigen::Vector3d wide = point.template cast<double>();
  kNumbers(file, wide);
  if constexpr (requires { point = wide.cast<float>(); }) point = wide.cast<float>();
};

constexpr auto kTile = [](auto& file, auto& tile) {
  file.whole(tile.index.x);
  file.whole(tile.index.y);
  file.whole(tile.index.z);
  file.whole(tile.graph_version);
  file.whole(tile.omitted);
  file.list(tile.ids, kWhole);
  file.list(tile.positions_m, kPoint);
  file.list(tile.observer_ends, kWhole);
  file.list(tile.observers, kWhole);
  if constexpr (requires { tile.omitted = 0; }) file.require(mapping::fault_of(tile).empty());
};

constexpr auto kGraph = [](auto& file, auto& graph) {
  file.list(graph.keyframes, kKeyframe);
  file.list(graph.edges, kEdge);
  file.number(graph.position_variance_m2);
};

void write_graph(Encoder& file, const std::optional<RecordedGraph>& graph) {
  file.maybe(graph, kGraph);
  if (graph) file.list(graph->landmarks, [](Encoder& to, const auto& entry) { kTile(to, entry.second); });
}

void read_graph(Decoder& file, std::optional<RecordedGraph>& graph) {
  file.maybe(graph, kGraph);
  if (!graph) return;
  std::vector<mapping::LandmarkTile> tiles;
  file.list(tiles, kTile);
  for (mapping::LandmarkTile& tile : tiles) graph->landmarks.emplace(tile.index, std::move(tile));
}

constexpr auto kSituation = [](auto& file, auto& situation) {
  file.list(situation.marks.driven, kCell);
  file.list(situation.marks.hindered, kCell);
  kPose(file, situation.robot);
  kMemory(file, situation.memory);
};

}  // namespace

std::vector<std::uint8_t> encode_situation(const RecordedSituation& situation) {
  Encoder content;
  kSituation(content, situation);
  write_graph(content, situation.graph);
  content.out.raw(mapping::encode_map(situation.map));
  files::ByteWriter file;
  for (const char c : kMagic) file.u8(static_cast<std::uint8_t>(c));
  file.u32(kFormatVersion);
  file.u32(files::crc32(content.out.bytes()));
  file.raw(content.out.bytes());
  return file.take();
}

std::optional<RecordedSituation> decode_situation(std::span<const std::uint8_t> bytes, std::string& error) {
  const auto refuse = [&error](std::string reason) {
    error = std::move(reason);
    return std::nullopt;
  };
  Decoder file{files::ByteReader(bytes)};
  const auto magic = file.in.raw(kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), kMagic.begin(), kMagic.end())) return refuse("it is no situation file");
  const std::uint32_t version = file.in.u32(), checksum = file.in.u32();
  if (version != kFormatVersion) return refuse("format version " + std::to_string(version) + " is not supported");
  if (checksum != files::crc32(bytes.last(file.in.remaining()))) return refuse("it is damaged");
  RecordedSituation situation{{mapping::VoxelMap(mapping::kDefaultResolution_m), {}, {}, {}}, {}, {}, {}, {}};
  kSituation(file, situation);
  read_graph(file, situation.graph);
  if (!file.in.is_good()) return refuse("its content makes no sense");
  auto map = mapping::decode_map(bytes.last(file.in.remaining()), error);
  if (!map) return std::nullopt;
  situation.map = std::move(*map);
  return situation;
}

}  // namespace lapis::planner
