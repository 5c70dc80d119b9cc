#include "slam/core/files/slam_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "common/files/atomic_file.hpp"
#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr std::string_view kMagic = "LAPISLAM";
constexpr std::uint32_t kFormatVersion = 5;
constexpr std::uint32_t kFirstWithWheels = 2;  // older versions can still be read
constexpr std::uint32_t kFirstWithIds = 3;
constexpr std::uint32_t kFirstWithDepthCamera = 4;
constexpr std::uint32_t kFirstWithSubMaps = 5;
constexpr std::size_t kTagSize = 4;
constexpr double kUnit16 = 32767.0;  // stands for a component of 1

template <class T, class Plain>
concept Is = std::same_as<std::remove_const_t<T>, Plain>;

// Content of the file, in this order, for writing and reading alike. A new field needs a line here, one in
// docs/slam_file.md and a check in find_fault(). A change of these lines needs a new kFormatVersion.

void fields(auto& data, Is<geometry::PinholeCamera> auto& camera) {
  data(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
}

void fields(auto& data, Is<SavedDepthCamera> auto& depth) {
  data(depth.camera.pinhole, depth.camera.distortion, depth.T_color_depth);
}

void fields(auto& data, Is<Feature> auto& feature) {
  data.single(feature.pixel.x());
  data.single(feature.pixel.y());
  data.single(feature.depth_m);
  data.byte(feature.octave);
  for (auto& word : feature.descriptor) data(word);
}

void fields(auto& data, Is<SurfaceSample> auto& sample) {
  for (int i = 0; i < 3; ++i) data.single(sample.point[i]);
  for (int i = 0; i < 3; ++i) data.unit(sample.normal[i]);
}

void fields(auto& data, Is<Keyframe> auto& keyframe) {
  data(keyframe.id, keyframe.stamp.nanoseconds, keyframe.camera, keyframe.T_map_camera, keyframe.features,
       keyframe.landmarks, keyframe.surface);
}

void fields(auto& data, Is<LandmarkState> auto& landmark) {
  for (int i = 0; i < 3; ++i) data(landmark.p_map[i]);
  data.single(landmark.finest_distance_m);
}

void fields(auto& data, Is<PoseGraphEdge> auto& edge) {
  data(edge.type, edge.from, edge.to, edge.T_from_to, edge.information);
}

void fields(auto& data, Is<KeyframeLink> auto& link) { data(link.from, link.to, link.T_from_to, link.information); }

void fields(auto& data, Is<WheelCalibration> auto& wheels) {
  data(wheels.distance_scale, wheels.distance_variance, wheels.turn_scale, wheels.turn_variance, wheels.noise,
       wheels.motions);
}

void fields(auto& data, Is<PublishedIds::Stretch> auto& stretch) { data(stretch.index, stretch.id); }

void fields(auto& data, Is<OdometryReading> auto& reading) { data(reading.stamp.nanoseconds, reading.T_odom_base); }

void fields(auto& data, Is<SavedMotion> auto& motion) {
  data(motion.stamp.nanoseconds, motion.camera.reference, motion.camera.T_reference_camera, motion.camera.covariance,
       motion.held_stamp.nanoseconds, motion.odometry);
}

void sections(auto& section, Is<SlamFile> auto& file, std::uint32_t version) {
  auto& state = file.state;
  section("INFO", file.session, state.graph_version, state.reference, state.scale_factor);
  section("KEYF", state.keyframes);
  section("COVA", state.covariances);
  section("LAND", state.landmarks);
  section("EDGE", state.edges);
  section("LINK", state.links);
  if (version >= kFirstWithWheels) section("WHEE", state.wheels);
  if (version < kFirstWithIds) return;
  section("NAME", file.epoch, file.keyframe_ids.stretches);
  section("ODOM", state.motion);
  if (version >= kFirstWithDepthCamera) section("DEPC", file.depth_camera);
  if (version >= kFirstWithSubMaps) section("PART", state.parts);
}

class Encoder {
 public:
  explicit Encoder(files::ByteWriter& out) : out_(out) {}

  void operator()(const auto&... values) { (put(values), ...); }
  void single(double v) { out_.f32(static_cast<float>(v)); }
  void byte(int v) { out_.u8(static_cast<std::uint8_t>(v)); }
  void unit(double v) { out_.u16(static_cast<std::uint16_t>(std::lround(std::clamp(v, -1.0, 1.0) * kUnit16))); }

 private:
  void put(std::uint32_t v) { out_.u32(v); }
  void put(std::uint64_t v) { out_.u64(v); }
  void put(std::int64_t v) { out_.u64(static_cast<std::uint64_t>(v)); }
  void put(int v) { out_.i32(v); }
  void put(double v) { out_.f64(v); }
  void put(EdgeType v) { out_.u8(static_cast<std::uint8_t>(v)); }
  void put(const Pose& T) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) put(T(row, column));
    }
  }
  void put(const Matrix6d& m) {
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) put(m(row, column));
    }
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(std::uint32_t{value.has_value()});
    if (value) put(*value);
  }
  template <class T>
  void put(const SharedArray<T>& values) {
    put(static_cast<const std::vector<T>&>(values));
  }
  template <class T>
  void put(const T& value) {
    fields(*this, value);
  }

  files::ByteWriter& out_;
};

template <class T>
T empty_element() {
  if constexpr (std::same_as<T, Matrix6d>) return Matrix6d::Zero();  // else its numbers would not be initialised
  return T{};
}

// Least number of bytes of an element: all numbers have fixed sizes, and lists may be empty.
template <class T>
std::size_t least_size() {
  static const std::size_t size = [] {
    files::ByteWriter out;
    Encoder{out}(empty_element<T>());
    return out.bytes().size();
  }();
  return size;
}

// A malformed number is read as zero, and the reader fails for good (files::ByteReader).
class Decoder {
 public:
  explicit Decoder(files::ByteReader& in) : in_(in) {}

  void operator()(auto&... values) { (get(values), ...); }
  void single(double& v) { v = in_.f32(); }
  void byte(int& v) { v = in_.u8(); }
  void unit(double& v) { v = static_cast<std::int16_t>(in_.u16()) / kUnit16; }

 private:
  void get(std::uint32_t& v) { v = in_.u32(); }
  void get(std::uint64_t& v) { v = in_.u64(); }
  void get(std::int64_t& v) { v = static_cast<std::int64_t>(in_.u64()); }
  void get(int& v) { v = in_.i32(); }
  void get(double& v) { v = in_.f64(); }
  void get(EdgeType& v) { v = static_cast<EdgeType>(in_.u8()); }
  void get(Pose& T) {
    T = Pose::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) get(T(row, column));
    }
  }
  void get(Matrix6d& m) {
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        get(m(i, j));
        m(j, i) = m(i, j);
      }
    }
  }
  template <class T>
  void get(std::vector<T>& values) {
    const std::size_t count = in_.u32();
    if (count > in_.remaining() / least_size<T>()) return in_.fail();
    values.resize(count);
    for (std::size_t i = 0; i < count && in_.is_good(); ++i) get(values[i]);
  }
  template <class T>
  void get(std::optional<T>& value) {
    const std::uint32_t count = in_.u32();
    if (count > 1) return in_.fail();
    if (count == 1) get(value.emplace());
  }
  template <class T>
  void get(SharedArray<T>& values) {
    std::vector<T> read;
    get(read);
    values = std::move(read);
  }
  template <class T>
  void get(T& value) {
    fields(*this, value);
  }

  files::ByteReader& in_;
};

// A section consists of its tag, a CRC-32 of what follows, the size of its content, and the content.
class SectionWriter {
 public:
  explicit SectionWriter(files::ByteWriter& out) : out_(out) {}

  void operator()(std::string_view tag, const auto&... values) {
    for (const char c : tag) out_.u8(static_cast<std::uint8_t>(c));
    const std::size_t checksum_at = out_.bytes().size();
    out_.u32(0);
    const std::size_t size_at = out_.bytes().size();
    out_.u64(0);
    const std::size_t content_at = out_.bytes().size();
    Encoder{out_}(values...);
    out_.set_u64(size_at, out_.bytes().size() - content_at);
    out_.set_u32(checksum_at, files::crc32(std::span(out_.bytes()).subspan(size_at)));
  }

 private:
  files::ByteWriter& out_;
};

// Stops at the first problem and keeps it.
class SectionReader {
 public:
  explicit SectionReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  void operator()(std::string_view tag, auto&... values) {
    if (!problem_.empty()) return;
    files::ByteReader in(bytes_);
    const auto name = in.raw(kTagSize);
    const std::uint32_t checksum = in.u32();
    const std::size_t checked = in.remaining();
    const std::uint64_t size = in.u64();
    const auto content = in.raw(size);
    if (!in.is_good()) return fail(tag, "is cut off");
    if (!std::equal(name.begin(), name.end(), tag.begin(), tag.end())) return fail(tag, "is not where it should be");
    if (files::crc32(bytes_.last(checked).first(checked - in.remaining())) != checksum)
      return fail(tag, "has another checksum than when it was written");
    files::ByteReader content_reader(content);
    Decoder{content_reader}(values...);
    if (!content_reader.is_good() || content_reader.remaining() > 0) return fail(tag, "is malformed");
    bytes_ = bytes_.last(in.remaining());
  }
  /// Empty when everything was read without a problem and nothing is left.
  std::string problem() const { return problem_.empty() && !bytes_.empty() ? "has bytes after its end" : problem_; }

 private:
  void fail(std::string_view tag, const char* what) {
    problem_ = "is damaged: its section " + std::string(tag) + " " + what;
  }

  std::span<const std::uint8_t> bytes_;
  std::string problem_;
};

bool is_sound(const SavedDepthCamera& depth) {
  const auto& distortion = depth.camera.distortion;
  constexpr std::array<std::size_t, 4> kLengths{0, 4, 5, 8};
  constexpr int kLargestSide = 16384;
  constexpr double kLargestFocal_px = 1e6, kFarthest_m = 10.0;
  const geometry::PinholeCamera& camera = depth.camera.pinhole;
  return geometry::is_valid(camera) && std::max(camera.width, camera.height) <= kLargestSide &&
         std::max(camera.fx, camera.fy) <= kLargestFocal_px && geometry::is_valid(depth.T_color_depth) &&
         depth.T_color_depth.translation().norm() <= kFarthest_m &&
         std::find(kLengths.begin(), kLengths.end(), distortion.size()) != kLengths.end() &&
         std::all_of(distortion.begin(), distortion.end(), [](double d) { return std::isfinite(d); });
}

struct Content {
  std::uint32_t version = 0;
  std::span<const std::uint8_t> bytes;
};

/// Content after the header; nothing, with the reason in `error`, when the header is not valid.
std::optional<Content> check_header(std::span<const std::uint8_t> bytes, std::string& error) {
  files::ByteReader in(bytes);
  const auto magic = in.raw(kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), kMagic.begin(), kMagic.end())) {
    error = "is not a map saved by lapis_slam";
    return std::nullopt;
  }
  const std::uint32_t version = in.u32();
  if (in.is_good() && version >= 1 && version <= kFormatVersion) return Content{version, bytes.last(in.remaining())};
  error = in.is_good() ? "has format version " + std::to_string(version) + ", this program reads 1 to " +
                             std::to_string(kFormatVersion)
                       : "is cut off";
  return std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> encode_slam_file(const SlamFile& file) {
  files::ByteWriter out;
  for (const char c : kMagic) out.u8(static_cast<std::uint8_t>(c));
  out.u32(kFormatVersion);
  SectionWriter section(out);
  sections(section, file, kFormatVersion);
  return out.take();
}

std::optional<SlamFile> decode_slam_file(std::span<const std::uint8_t> bytes, std::string& error) {
  const auto content = check_header(bytes, error);
  if (!content) return std::nullopt;
  SlamFile file;
  SectionReader section(content->bytes);
  sections(section, file, content->version);
  error = section.problem();
  if (!error.empty()) return std::nullopt;
  if (file.session < 0 || file.session > kLastStamp_ns) {
    error = "has a session out of range";
    return std::nullopt;
  }
  const bool ids_are_sound =
      file.keyframe_ids.are_sound() && file.keyframe_ids.of(file.state.keyframes.size()) < PublishedIds::kEnd;
  if (!ids_are_sound || file.epoch < 0 || file.epoch > kLastStamp_ns) {
    error = "has published ids or an epoch out of range";
    return std::nullopt;
  }
  if (file.depth_camera && !is_sound(*file.depth_camera)) {
    error = "has a depth camera that cannot be";
    return std::nullopt;
  }
  if (const auto fault = find_fault(file.state)) {
    error = "holds no sound map: " + *fault;
    return std::nullopt;
  }
  return file;
}

std::optional<std::string> write_slam_file(const std::string& path, const SlamFile& file) {
  return files::replace_file(path, encode_slam_file(file));
}

std::optional<SlamFile> read_slam_file(const std::string& path, std::string& error) {
  const auto bytes = files::read_file(path, error);
  if (!bytes) return std::nullopt;
  auto file = decode_slam_file(*bytes, error);
  if (!file) error = path + ": " + error;
  return file;
}

}  // namespace lapis::slam
