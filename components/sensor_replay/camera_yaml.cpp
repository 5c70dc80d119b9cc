#include "sensor_replay/camera_yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "sensor_replay/core/text_table.hpp"

namespace lapis::sensor_replay {
namespace {

using Names = std::vector<std::string>;

/// The keys of a map.
struct Keys {
  Names required, optional;
  bool contains(const std::string& name) const {
    const auto has = [&](const Names& names) { return std::find(names.begin(), names.end(), name) != names.end(); };
    return has(required) || has(optional);
  }
  std::string text() const {
    std::string names;
    for (const Names& some : {required, optional}) {
      for (const std::string& name : some) names += (names.empty() ? "" : ", ") + name;
    }
    return names;
  }
};

const Keys& file_keys() {
  static const Keys keys{{"width", "height", "fx", "fy", "cx", "cy", "depth_scale", "fps"},
                         {"distortion", "camera_height", "pitch_down_deg", "depth"}};
  return keys;
}
const Keys& depth_keys() {
  static const Keys keys{{"width", "height", "fx", "fy", "cx", "cy"}, {"distortion", "position", "rpy_deg"}};
  return keys;
}

/// A map of the file: the whole of it, or one that is the value of a key.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const YAML::Node& root, const Keys& keys) : file_(file), root_(root) {
    check(keys);
  }

  std::optional<Reader> map(const char* key, const Keys& keys) const {
    return root_[key] ? std::optional(Reader(file_, root_[key], keys)) : std::nullopt;
  }

  double number(const char* key, double low, double high) const { return number(key, root_[key], low, high); }

  double number_or_zero(const char* key, double low, double high) const {
    return root_[key] ? number(key, low, high) : 0.0;
  }

  int size(const char* key, int low, int high) const {
    const double value = number(key, low, high);
    if (value != std::floor(value)) fail_at(file_, line(root_[key]), std::string(key) + ": must be a whole number");
    return static_cast<int>(value);
  }

  /// A list of N numbers, or zeros where there is none. `what`: the numbers in words.
  template <std::size_t N>
  std::array<double, N> numbers(const char* key, const char* what, double limit) const {
    std::array<double, N> result{};
    const YAML::Node node = root_[key];
    if (!node) return result;
    if (!node.IsSequence() || node.size() != N) fail_at(file_, line(node), std::string(key) + ": must be " + what);
    for (std::size_t i = 0; i < N; ++i) result[i] = number(key, node[i], -limit, limit);
    return result;
  }

  geometry::PinholeCamera pinhole() const {
    geometry::PinholeCamera camera;
    camera.width = size("width", 16, 16384);
    camera.height = size("height", 16, 16384);
    camera.fx = number("fx", 1.0, 1e5);
    camera.fy = number("fy", 1.0, 1e5);
    camera.cx = number("cx", 0.0, camera.width);
    camera.cy = number("cy", 0.0, camera.height);
    return camera;
  }
  std::array<double, 5> distortion() const {
    return numbers<5>("distortion", "five numbers [k1, k2, p1, p2, k3]", 10.0);
  }

 private:
  static int line(const YAML::Node& node) { return node.Mark().line + 1; }

  double number(const char* key, const YAML::Node& node, double low, double high) const {
    const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
    if (value && *value >= low && *value <= high) return *value;
    std::ostringstream what;
    what << key << ": must be a number from " << low << " to " << high;
    if (node.IsScalar()) what << ", not \"" << node.Scalar() << "\"";
    fail_at(file_, line(node), what.str());
  }

  void check(const Keys& keys) const {
    if (!root_.IsMap()) throw std::runtime_error(file_.string() + ": must be a list of \"key: value\"");
    std::set<std::string> seen;
    for (const auto& entry : root_) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (!keys.contains(name)) {
        fail_at(file_, line(entry.first), "unknown key \"" + name + "\"; known are " + keys.text());
      }
      if (!seen.insert(name).second) fail_at(file_, line(entry.first), "key \"" + name + "\" occurs twice");
    }
    for (const std::string& key : keys.required) {
      if (!seen.contains(key)) throw std::runtime_error(file_.string() + ": key \"" + key + "\" is missing");
    }
  }

  std::filesystem::path file_;
  YAML::Node root_;
};

YAML::Node load(const std::filesystem::path& file) {
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::Exception& error) {
    // The mark of an unreadable file is null (line -1).
    fail_at(file, error.mark.line + 1, "not valid YAML: " + error.msg);
  }
}

/// In the order of ROS: about the fixed axes x, y, z.
Eigen::Quaterniond rotation_of(const std::array<double, 3>& rpy_deg) {
  const auto turn = [&](std::size_t i) {
    return Eigen::AngleAxisd(rpy_deg[i] * std::numbers::pi / 180.0,
                             Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i)));
  };
  return turn(2) * turn(1) * turn(0);
}

DepthCameraFile depth_camera(const Reader& reader) {
  const auto distortion = reader.distortion();
  const auto position = reader.numbers<3>("position", "three numbers [x, y, z]", 1.0);
  const auto rpy_deg = reader.numbers<3>("rpy_deg", "three numbers [roll, pitch, yaw]", 180.0);
  return {{reader.pinhole(), {distortion.begin(), distortion.end()}},
          geometry::make_pose({position[0], position[1], position[2]}, rotation_of(rpy_deg))};
}

}  // namespace

CameraFile read_camera_file(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw std::runtime_error(file.string() + ": not found; write the camera's calibration into it, for example: " +
                             example_camera_file(file.parent_path().filename().string()));
  }
  const Reader reader(file, load(file), file_keys());
  CameraFile result;
  result.camera = reader.pinhole();
  result.distortion = reader.distortion();
  if (const auto depth = reader.map("depth", depth_keys())) result.depth_camera = depth_camera(*depth);
  result.depth_scale = reader.number("depth_scale", 1.0, 1e5);
  result.fps = reader.number("fps", 0.1, 1000.0);
  result.mount.height_m = reader.number_or_zero("camera_height", 0.0, 10.0);
  result.mount.pitch_down_rad = reader.number_or_zero("pitch_down_deg", -90.0, 90.0) * std::numbers::pi / 180.0;
  return result;
}

std::string example_camera_file(const std::string& sequence_name) {
  // Calibrations of the cameras of the TUM RGB-D benchmark, as published [Sturm 2012]; depth is in 1/5000 m.
  const char* calibration = "fx: 525.0, fy: 525.0, cx: 319.5, cy: 239.5, distortion: [0, 0, 0, 0, 0]";
  if (sequence_name.find("freiburg1") != std::string::npos) {
    calibration = "fx: 517.3, fy: 516.5, cx: 318.6, cy: 255.3, distortion: [0.2624, -0.9531, -0.0054, 0.0026, 1.1633]";
  } else if (sequence_name.find("freiburg2") != std::string::npos) {
    calibration = "fx: 520.9, fy: 521.0, cx: 325.1, cy: 249.7, distortion: [0.2312, -0.7849, -0.0033, -0.0001, 0.9172]";
  } else if (sequence_name.find("freiburg3") != std::string::npos) {
    calibration = "fx: 535.4, fy: 539.2, cx: 320.1, cy: 247.6, distortion: [0, 0, 0, 0, 0]";
  }
  return std::string("{width: 640, height: 480, ") + calibration + ", depth_scale: 5000, fps: 30}";
}

}  // namespace lapis::sensor_replay
