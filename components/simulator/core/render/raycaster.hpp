#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// The point where a ray hit the mesh.
struct RayHit {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  float distance = 0.0F;  ///< in lengths of the ray's direction
  std::uint32_t triangle = kNone;
  float u = 0.0F;  ///< barycentric weight of the triangle's second vertex
  float v = 0.0F;  ///< the same of its third vertex
};

struct Ray {
  Eigen::Vector3f origin{0, 0, 0};     ///< [m]
  Eigen::Vector3f direction{0, 0, 1};  ///< not zero, of any length
};

/// Rays from one point in similar directions, with an array per coordinate.
struct RayPacket {
  static constexpr int kSize = 8;
  Eigen::Vector3f origin{0, 0, 0};                     ///< [m]
  alignas(32) std::array<float, kSize> x{}, y{}, z{};  ///< directions, not zero, of any length
};

/// Hits of the rays of a RayPacket; see RayHit.
struct HitPacket {
  alignas(32) std::array<float, RayPacket::kSize> distance, u, v;  ///< zero where nothing was hit
  std::array<std::uint32_t, RayPacket::kSize> triangle;
};

/// Casts rays against a mesh. Rays pass through the holes of cut-out textures. All functions may be called from several
/// threads; the same rays in the same packets give the same bytes on every machine that has AVX2.
class SceneRaycaster {
 public:
  static constexpr int kPacket = 16;  ///< greatest number of rays for occluded()

  /// The mesh must be sound (problem_of) and outlive the caster.
  explicit SceneRaycaster(const Mesh& mesh);
  ~SceneRaycaster();
  SceneRaycaster(const SceneRaycaster&) = delete;
  SceneRaycaster& operator=(const SceneRaycaster&) = delete;

  /// First hit within `longest` lengths of the direction; nothing when there is none.
  std::optional<RayHit> cast(const Ray& ray, float longest) const;
  /// Casts eight rays at once; it is faster when their directions are similar.
  void cast(const RayPacket& rays, float longest, HitPacket& hits) const;
  /// Bit i is set when ray i hits something nearer than longest[i] lengths of its direction; at most kPacket rays.
  unsigned int occluded(std::span<const Ray> rays, std::span<const float> longest) const;

  /// Instruction set with which rays are cast: "avx2", or "default" on a machine without it.
  const char* instruction_set() const;
  const Mesh& mesh() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::simulator
