#include "slam/core/files/pose_graph_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <optional>
#include <ostream>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr std::size_t kInformationNumbers = 21;
constexpr double kMaxCoordinate = 1e9, kMaxInformation = 1e18;
// Rounding of decimals may make a zero eigenvalue as negative as this share of the trace; it becomes zero again.
constexpr double kRounding = 1e-6;

// Forms of a vertex: g2o's and TORO's, in the plane and in space.
enum class Form { kPlanar, kSpatial, kToroPlanar, kToroSpatial };

struct Tag {
  std::string_view word;
  Form form;
  bool is_vertex;
};
constexpr std::array kTags = {Tag{"VERTEX_SE2", Form::kPlanar, true},       Tag{"EDGE_SE2", Form::kPlanar, false},
                              Tag{"VERTEX_SE3:QUAT", Form::kSpatial, true}, Tag{"EDGE_SE3:QUAT", Form::kSpatial, false},
                              Tag{"VERTEX2", Form::kToroPlanar, true},      Tag{"EDGE2", Form::kToroPlanar, false},
                              Tag{"VERTEX3", Form::kToroSpatial, true},     Tag{"EDGE3", Form::kToroSpatial, false}};

bool is_planar(Form form) { return form == Form::kPlanar || form == Form::kToroPlanar; }
std::size_t pose_numbers(Form form) {
  if (is_planar(form)) return 3;
  return form == Form::kSpatial ? 7 : 6;
}
std::size_t information_numbers(Form form) { return is_planar(form) ? 6 : kInformationNumbers; }

// Scale of row or column i from a rotation vector (in memory) to the vector part of a quaternion (in the file).
double file_scale(int i) { return i < 3 ? 1.0 : 2.0; }

// Shortest decimal that reads back as the same double.
void append_number(std::string& line, double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value == 0.0 ? 0.0 : value).ptr;
  line += ' ';
  line.append(buffer.data(), end);
}

void append_pose(std::string& line, const Pose& T, bool planar) {
  for (int i = 0; i < (planar ? 2 : 3); ++i) append_number(line, T.translation()[i]);
  if (planar) return append_number(line, std::atan2(T(1, 0), T(0, 0)));
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) append_number(line, value);
}

void append_information(std::string& line, const Matrix6d& information, bool planar) {
  const auto is_left_out = [planar](int i) { return planar && i >= 2 && i <= 4; };
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      if (is_left_out(row) || is_left_out(column)) continue;
      const double scale = planar ? 1.0 : file_scale(row) * file_scale(column);
      append_number(line, information(row, column) * scale);
    }
  }
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

// Parses the words of one line. Errors are thrown inside this file only; read_g2o returns them as a value.
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
  double number(double limit) {
    const auto value = parse<double>(words_[next_]);
    if (!value || !std::isfinite(*value)) fail("is not a finite number");
    if (std::abs(*value) > limit) fail("is too large");
    ++next_;
    return *value;
  }
  Pose pose(Form form) {
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < pose_numbers(form); ++i) v[i] = number(kMaxCoordinate);
    if (is_planar(form)) return geometry::make_pose({v[0], v[1], 0.0}, turn(v[2], Eigen::Vector3d::UnitZ()));
    Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (form == Form::kToroSpatial) {
      q = turn(v[5], Eigen::Vector3d::UnitZ()) * turn(v[4], Eigen::Vector3d::UnitY()) *
          turn(v[3], Eigen::Vector3d::UnitX());
    }
    if (!(q.norm() > 1e-6 && q.norm() < 1e6)) throw PoseGraphFileError{"quaternion has no length"};
    return geometry::make_pose({v[0], v[1], v[2]}, q);
  }
  Matrix6d information(Form form) {
    Matrix6d result = Matrix6d::Identity();
    const auto next = [&] { return number(kMaxInformation); };
    const auto set = [&](int i, int j, double value) { result(i, j) = result(j, i) = value; };
    if (form == Form::kToroPlanar) {
      for (const auto& [i, j] : {std::pair(0, 0), {0, 1}, {1, 1}, {5, 5}, {0, 5}, {1, 5}}) set(i, j, next());
    } else if (form == Form::kPlanar) {
      for (const auto& [i, j] : {std::pair(0, 0), {0, 1}, {0, 5}, {1, 1}, {1, 5}, {5, 5}}) set(i, j, next());
    } else {
      for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) set(i, j, next() / (form == Form::kSpatial ? file_scale(i) * file_scale(j) : 1.0));
      }
    }
    if (result.llt().info() == Eigen::Success) return result;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> parts(result);
    if (parts.eigenvalues().minCoeff() < -kRounding * result.trace()) {
      throw PoseGraphFileError{"information is not positive semi-definite"};
    }
    return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() * parts.eigenvectors().transpose();
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw PoseGraphFileError{"'" + std::string(words_[next_].substr(0, 40)) + "' " + what};
  }

  static Eigen::Quaterniond turn(double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  }

  std::vector<std::string_view> words_;
  std::size_t next_ = 1;
};

// What has been read so far.
struct Reading {
  PoseGraphSnapshot graph;
  std::set<std::uint64_t> ids;
};

void read_vertex(LineReader& reader, Form form, Reading& reading) {
  reader.expect(1, pose_numbers(form));
  PoseGraphNode node;
  node.id = reader.id();
  node.T_map_camera = reader.pose(form);
  if (!reading.ids.insert(node.id).second) {
    throw PoseGraphFileError{"vertex " + std::to_string(node.id) + " appears twice"};
  }
  reading.graph.nodes.push_back(node);
}

void read_edge(LineReader& reader, Form form, Reading& reading) {
  reader.expect(2, pose_numbers(form) + information_numbers(form));
  PoseGraphEdge edge;
  edge.from = reader.id();
  edge.to = reader.id();
  if (edge.from == edge.to) throw PoseGraphFileError{"edge from vertex " + std::to_string(edge.to) + " to itself"};
  edge.T_from_to = reader.pose(form);
  edge.information = reader.information(form);
  reading.graph.edges.push_back(edge);
}

void read_line(std::string_view line, Reading& reading) {
  const std::vector<std::string_view> words = split(line);
  if (words.empty()) return;
  const auto tag = std::find_if(kTags.begin(), kTags.end(), [&](const Tag& t) { return t.word == words[0]; });
  if (tag == kTags.end()) return;
  PoseGraphSnapshot& graph = reading.graph;
  if (graph.nodes.empty() && graph.edges.empty()) graph.is_planar = is_planar(tag->form);
  if (graph.is_planar != is_planar(tag->form)) throw PoseGraphFileError{"poses in the plane and in space are mixed"};
  if (std::max(graph.nodes.size(), graph.edges.size()) >= kMaxGraphFileElements) {
    throw PoseGraphFileError{"more than " + std::to_string(kMaxGraphFileElements) + " vertices or edges"};
  }
  LineReader reader(words);
  if (tag->is_vertex) {
    read_vertex(reader, tag->form, reading);
  } else {
    read_edge(reader, tag->form, reading);
  }
}

// getline with a limit on the length of a line; throws for a longer one.
bool next_line(std::istream& stream, std::string& line) {
  line.clear();
  for (auto c = stream.rdbuf()->sbumpc(); c != std::istream::traits_type::eof(); c = stream.rdbuf()->sbumpc()) {
    if (c == '\n') return true;
    if (line.size() >= kMaxGraphFileLine) throw PoseGraphFileError{"the line is too long"};
    line.push_back(std::istream::traits_type::to_char_type(c));
  }
  return !line.empty();
}

}  // namespace

void write_g2o(std::ostream& stream, const PoseGraphSnapshot& graph) {
  const bool planar = graph.is_planar;
  for (const PoseGraphNode& node : graph.nodes) {
    std::string line = (planar ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ") + std::to_string(node.id);
    append_pose(line, node.T_map_camera, planar);
    stream << line << '\n';
  }
  for (const PoseGraphEdge& edge : graph.edges) {
    std::string line =
        (planar ? "EDGE_SE2 " : "EDGE_SE3:QUAT ") + std::to_string(edge.from) + " " + std::to_string(edge.to);
    append_pose(line, edge.T_from_to, planar);
    append_information(line, edge.information, planar);
    stream << line << '\n';
  }
}

std::variant<PoseGraphSnapshot, PoseGraphFileError> read_g2o(std::istream& stream) {
  Reading reading;
  std::string line;
  std::size_t number = 1;
  try {
    for (; next_line(stream, line); ++number) read_line(line, reading);
  } catch (const PoseGraphFileError& error) {
    return PoseGraphFileError{"line " + std::to_string(number) + ": " + error.message};
  }
  return std::move(reading.graph);
}

}  // namespace lapis::slam
