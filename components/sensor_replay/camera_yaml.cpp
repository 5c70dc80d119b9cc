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

constexpr std::array kRequiredKeys{"width", "height", "fx", "fy", "cx", "cy", "depth_scale", "fps"};
constexpr std::array kOptionalKeys{"distortion", "camera_height", "pitch_down_deg"};

class Reader {
 public:
  Reader(const std::filesystem::path& file, const YAML::Node& root) : file_(file), root_(root) { check_keys(); }

  double number(const char* key, double low, double high) const { return number(key, root_[key], low, high); }

  double number_or_zero(const char* key, double low, double high) const {
    return root_[key] ? number(key, low, high) : 0.0;
  }

  int size(const char* key, int low, int high) const {
    const double value = number(key, low, high);
    if (value != std::floor(value)) fail_at(file_, line(root_[key]), std::string(key) + ": must be a whole number");
    return static_cast<int>(value);
  }

  std::array<double, 5> distortion() const {
    std::array<double, 5> result{};
    const YAML::Node node = root_["distortion"];
    if (!node) return result;
    if (!node.IsSequence() || node.size() != result.size()) {
      fail_at(file_, line(node), "distortion: must be five numbers [k1, k2, p1, p2, k3]");
    }
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = number("distortion", node[i], -10.0, 10.0);
    return result;
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

  void check_keys() const {
    if (!root_.IsMap()) throw std::runtime_error(file_.string() + ": must be a list of \"key: value\"");
    std::set<std::string> seen;
    for (const auto& entry : root_) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (!is_known(name)) fail_at(file_, line(entry.first), "unknown key \"" + name + "\"; known are " + known_keys());
      if (!seen.insert(name).second) fail_at(file_, line(entry.first), "key \"" + name + "\" occurs twice");
    }
    for (const char* key : kRequiredKeys) {
      if (!seen.contains(key)) throw std::runtime_error(file_.string() + ": key \"" + key + "\" is missing");
    }
  }

  static bool is_known(const std::string& name) {
    return std::find(kRequiredKeys.begin(), kRequiredKeys.end(), name) != kRequiredKeys.end() ||
           std::find(kOptionalKeys.begin(), kOptionalKeys.end(), name) != kOptionalKeys.end();
  }

  static std::string known_keys() {
    std::string names;
    for (const char* key : kRequiredKeys) names += std::string(key) + ", ";
    for (const char* key : kOptionalKeys) names += std::string(key) + ", ";
    return names.substr(0, names.size() - 2);
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

}  // namespace

CameraFile read_camera_file(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw std::runtime_error(file.string() + ": not found; write the camera's calibration into it, for example: " +
                             example_camera_file(file.parent_path().filename().string()));
  }
  const Reader reader(file, load(file));
  CameraFile result;
  result.camera.width = reader.size("width", 16, 16384);
  result.camera.height = reader.size("height", 16, 16384);
  result.camera.fx = reader.number("fx", 1.0, 1e5);
  result.camera.fy = reader.number("fy", 1.0, 1e5);
  result.camera.cx = reader.number("cx", 0.0, result.camera.width);
  result.camera.cy = reader.number("cy", 0.0, result.camera.height);
  result.distortion = reader.distortion();
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
