#include "slam/core/pose_graph_file.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <optional>
#include <ostream>
#include <set>
#include <string_view>
#include <vector>

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr std::string_view kVertex = "VERTEX_SE3:QUAT";
constexpr std::string_view kEdge = "EDGE_SE3:QUAT";
constexpr std::size_t kPoseNumbers = 7;
constexpr std::size_t kInformationNumbers = 21;

// Scale of row or column i between a rotation vector (ours) and the vector part of a quaternion (the file's).
double file_scale(int i) { return i < 3 ? 1.0 : 2.0; }

// Shortest decimal that reads back as the same double.
void append_number(std::string& line, double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value == 0.0 ? 0.0 : value).ptr;
  line += ' ';
  line.append(buffer.data(), end);
}

void append_pose(std::string& line, const Pose& T) {
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  for (int i = 0; i < 3; ++i) append_number(line, T.translation()[i]);
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) append_number(line, value);
}

std::vector<std::string_view> split(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r";
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
  return words;
}

template <class Number>
std::optional<Number> parse(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// Parses one line's words; errors are thrown inside this file only and become a value in read_g2o.
class LineReader {
 public:
  explicit LineReader(std::vector<std::string_view> words) : words_(std::move(words)) {}

  void expect(std::size_t ids, std::size_t numbers) const {
    if (words_.size() == 1 + ids + numbers) return;
    throw PoseGraphFileError{std::string(words_[0]) + " needs " + std::to_string(ids + numbers) + " numbers, has " +
                             std::to_string(words_.size() - 1)};
  }
  std::uint64_t id() {
    const auto value = parse<std::uint64_t>(words_[next_]);
    if (!value) fail("is not an id");
    ++next_;
    return *value;
  }
  double number() {
    const auto value = parse<double>(words_[next_]);
    if (!value || !std::isfinite(*value)) fail("is not a finite number");
    ++next_;
    return *value;
  }
  Pose pose() {
    std::array<double, kPoseNumbers> v{};
    for (double& value : v) value = number();
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (!(q.norm() > 1e-6 && q.norm() < 1e6)) throw PoseGraphFileError{"quaternion has no length"};
    return geometry::make_pose({v[0], v[1], v[2]}, q);
  }
  Matrix6d information() {
    Matrix6d result;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) result(i, j) = result(j, i) = number() / (file_scale(i) * file_scale(j));
    }
    return result;
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw PoseGraphFileError{"'" + std::string(words_[next_].substr(0, 40)) + "' " + what};
  }

  std::vector<std::string_view> words_;
  std::size_t next_ = 1;
};

void read_line(std::string_view line, PoseGraphSnapshot& graph, std::set<std::uint64_t>& ids) {
  const std::vector<std::string_view> words = split(line);
  if (words.empty() || (words[0] != kVertex && words[0] != kEdge)) return;
  LineReader reader(words);
  if (words[0] == kVertex) {
    reader.expect(1, kPoseNumbers);
    PoseGraphNode node;
    node.id = reader.id();
    node.T_map_camera = reader.pose();
    if (!ids.insert(node.id).second) throw PoseGraphFileError{"vertex " + std::to_string(node.id) + " appears twice"};
    graph.nodes.push_back(node);
    return;
  }
  reader.expect(2, kPoseNumbers + kInformationNumbers);
  PoseGraphEdge edge;
  edge.from = reader.id();
  edge.to = reader.id();
  edge.T_from_to = reader.pose();
  edge.information = reader.information();
  graph.edges.push_back(edge);
}

}  // namespace

void write_g2o(std::ostream& stream, const PoseGraphSnapshot& graph) {
  for (const PoseGraphNode& node : graph.nodes) {
    std::string line = std::string(kVertex) + " " + std::to_string(node.id);
    append_pose(line, node.T_map_camera);
    stream << line << '\n';
  }
  for (const PoseGraphEdge& edge : graph.edges) {
    std::string line = std::string(kEdge) + " " + std::to_string(edge.from) + " " + std::to_string(edge.to);
    append_pose(line, edge.T_from_to);
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        append_number(line, edge.information(row, column) * file_scale(row) * file_scale(column));
      }
    }
    stream << line << '\n';
  }
}

std::variant<PoseGraphSnapshot, PoseGraphFileError> read_g2o(std::istream& stream) {
  PoseGraphSnapshot graph;
  std::set<std::uint64_t> ids;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    try {
      read_line(line, graph, ids);
    } catch (const PoseGraphFileError& error) {
      return PoseGraphFileError{"line " + std::to_string(number) + ": " + error.message};
    }
  }
  return graph;
}

}  // namespace lapis::slam
