#include "tests/support/synthetic_camera.hpp"

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::test {
namespace {

using sensor_msgs::msg::Image;

const Eigen::Vector3d kHalfBox(2.0, 1.5, 3.0);
constexpr double kTexel_m = 0.04;

struct Hit {
  double depth_m = 0.0;  // along the optical axis
  int wall = 0;          // 0 to 5: -x +x -y +y -z +z
  Eigen::Vector3d p_box;
};

// From inside a box a ray leaves through the nearest of the three walls that it faces.
Hit cast(const Eigen::Vector3d& ray, const geometry::Pose& T_box_camera) {
  const Eigen::Vector3d direction = T_box_camera.linear() * ray;
  const Eigen::Vector3d origin = T_box_camera.translation();
  Hit hit;
  hit.depth_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    const double wall = direction[axis] > 0 ? kHalfBox[axis] : -kHalfBox[axis];
    const double distance = (wall - origin[axis]) / direction[axis];
    if (distance < hit.depth_m) {
      hit.depth_m = distance;
      hit.wall = 2 * axis + (direction[axis] > 0 ? 1 : 0);
    }
  }
  hit.p_box = origin + hit.depth_m * direction;
  return hit;
}

// A fixed random grey value per texel of a wall.
std::uint8_t texture(const Hit& hit) {
  std::uint64_t hash = static_cast<std::uint64_t>(hit.wall) + 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = axis == hit.wall / 2 ? 0 : static_cast<std::int64_t>(std::floor(hit.p_box[axis] / kTexel_m));
    hash = (hash ^ static_cast<std::uint64_t>(cell + 1000)) * 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 29;
  }
  return static_cast<std::uint8_t>(40 + (hash >> 32) % 176);
}

Image blank(const geometry::PinholeCamera& camera, time::Time stamp, const char* encoding, std::size_t pixel_bytes) {
  Image image;
  image.header().stamp(messages::to_message(stamp));
  image.header().frame_id(SyntheticCamera::kOpticalFrame);
  image.width(static_cast<std::uint32_t>(camera.width));
  image.height(static_cast<std::uint32_t>(camera.height));
  image.encoding(encoding);
  image.step(static_cast<std::uint32_t>(static_cast<std::size_t>(camera.width) * pixel_bytes));
  image.data().resize(static_cast<std::size_t>(image.step()) * image.height());
  return image;
}

// Where the lens (Brown, 1966: k1 k2 p1 p2 k3) puts what a pinhole would see at (x, y), both at z = 1.
Eigen::Vector2d bend(const std::vector<double>& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  return radial * p + Eigen::Vector2d(2.0 * d[2] * p.x() * p.y() + d[3] * (r2 + 2.0 * p.x() * p.x()),
                                      d[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * d[3] * p.x() * p.y());
}

// The inverse of bend() by Newton's method with a numeric Jacobian.
Eigen::Vector2d straighten(const std::vector<double>& d, const Eigen::Vector2d& bent) {
  constexpr double kStep = 1e-6;
  Eigen::Vector2d p = bent;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix2d J;
    J.col(0) = (bend(d, p + Eigen::Vector2d(kStep, 0.0)) - bend(d, p)) / kStep;
    J.col(1) = (bend(d, p + Eigen::Vector2d(0.0, kStep)) - bend(d, p)) / kStep;
    p -= J.inverse() * (bend(d, p) - bent);
  }
  return p;
}

std::vector<Eigen::Vector3d> rays_of(const geometry::PinholeCamera& camera, const std::vector<double>& distortion) {
  std::vector<Eigen::Vector3d> rays;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1.0);
      rays.push_back(distortion.empty() ? ray : straighten(distortion, ray.head<2>()).homogeneous().eval());
    }
  }
  return rays;
}

/// Writes `pixel(hit)`, a value of the size of a pixel, everywhere.
template <class Pixel>
Image render(const geometry::PinholeCamera& camera, const std::vector<Eigen::Vector3d>& rays, time::Time stamp,
             const char* encoding, const geometry::Pose& T_box_camera, Pixel pixel) {
  using Value = decltype(pixel(Hit{}));
  Image image = blank(camera, stamp, encoding, sizeof(Value));
  std::uint8_t* target = image.data().data();
  for (const Eigen::Vector3d& ray : rays) {
    const Value value = pixel(cast(ray, T_box_camera));
    std::memcpy(target, &value, sizeof value);
    target += sizeof value;
  }
  return image;
}

}  // namespace

SyntheticCamera::SyntheticCamera(int width, int height, const std::vector<double>& distortion)
    : camera_{width, height, 0.9 * width, 0.9 * width, 0.5 * (width - 1), 0.5 * (height - 1)}, distortion_(distortion),
      rays_(rays_of(camera_, distortion)) {}

Image SyntheticCamera::color(time::Time stamp, const geometry::Pose& T_box_camera) const {
  return render(camera_, rays_, stamp, "rgb8", T_box_camera, [](const Hit& hit) {
    const std::uint8_t grey = texture(hit);
    return std::array<std::uint8_t, 3>{grey, grey, static_cast<std::uint8_t>(grey / 2 + 20 * hit.wall)};
  });
}

Image SyntheticCamera::depth(time::Time stamp, const geometry::Pose& T_box_camera) const {
  return render(camera_, rays_, stamp, "16UC1", T_box_camera,
                [](const Hit& hit) { return static_cast<std::uint16_t>(std::lround(1000.0 * hit.depth_m)); });
}

Image SyntheticCamera::depth_metres(time::Time stamp, const geometry::Pose& T_box_camera) const {
  return render(camera_, rays_, stamp, "32FC1", T_box_camera,
                [](const Hit& hit) { return static_cast<float>(hit.depth_m); });
}

Image SyntheticCamera::labels(time::Time stamp, const geometry::Pose& T_box_camera) const {
  return render(camera_, rays_, stamp, "mono8", T_box_camera,
                [](const Hit& hit) { return static_cast<std::uint8_t>(hit.wall + 1); });
}

sensor_msgs::msg::CameraInfo SyntheticCamera::info(time::Time stamp) const {
  sensor_msgs::msg::CameraInfo message;
  message.header().stamp(messages::to_message(stamp));
  message.header().frame_id(kOpticalFrame);
  message.width(static_cast<std::uint32_t>(camera_.width));
  message.height(static_cast<std::uint32_t>(camera_.height));
  message.distortion_model("plumb_bob");
  message.d(distortion_.empty() ? std::vector<double>(5, 0.0) : distortion_);
  message.k({camera_.fx, 0.0, camera_.cx, 0.0, camera_.fy, camera_.cy, 0.0, 0.0, 1.0});
  message.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  message.p({camera_.fx, 0.0, camera_.cx, 0.0, 0.0, camera_.fy, camera_.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
  return message;
}

vision_msgs::msg::LabelInfo SyntheticCamera::label_info() const {
  vision_msgs::msg::LabelInfo message;
  message.header().frame_id(kOpticalFrame);
  for (int id = 1; id <= kClasses; ++id) {
    vision_msgs::msg::VisionClass entry;
    entry.class_id(static_cast<std::uint16_t>(id));
    entry.class_name("wall" + std::to_string(id));
    message.class_map().push_back(entry);
  }
  return message;
}

geometry::Pose T_base_camera() {
  // Optical axes in the base: x right = -y, y down = -z, z forward = x [REP 103].
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return geometry::make_pose(Eigen::Vector3d(0.1, 0.0, 0.3), Eigen::Quaterniond(axes));
}

tf2_msgs::msg::TFMessage camera_mount(const std::string& prefix) {
  geometry_msgs::msg::TransformStamped transform;
  transform.header().frame_id(prefix + "base_link");
  transform.child_frame_id(prefix + SyntheticCamera::kOpticalFrame);
  transform.transform(messages::to_transform(T_base_camera()));
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(transform);
  return message;
}

geometry::Pose slow_motion(double frame) {
  return geometry::make_pose(Eigen::Vector3d(0.005 * frame, 0.05 * std::sin(0.1 * frame), 0.01 * frame),
                             Eigen::Quaterniond(Eigen::AngleAxisd(0.004 * frame, Eigen::Vector3d::UnitY())));
}

}  // namespace lapis::test
