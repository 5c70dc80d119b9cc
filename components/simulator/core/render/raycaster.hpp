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

/// Where a ray met the mesh.
struct RayHit {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  float distance = 0.0F;  ///< in lengths of the ray's direction
  std::uint32_t triangle = kNone;
  float u = 0.0F;  ///< barycentric weight of the triangle's second vertex
  float v = 0.0F;  ///< of its third
};

struct Ray {
  Eigen::Vector3f origin{0, 0, 0};     ///< [m]
  Eigen::Vector3f direction{0, 0, 1};  ///< not zero, of any length
};

/// Rays from one point, alike in direction, each number in an array of its own.
struct RayPacket {
  static constexpr int kSize = 8;
  Eigen::Vector3f origin{0, 0, 0};                     ///< [m]
  alignas(32) std::array<float, kSize> x{}, y{}, z{};  ///< directions, not zero, of any length
};

/// What they meet; as in RayHit.
struct HitPacket {
  alignas(32) std::array<float, RayPacket::kSize> distance, u, v;  ///< zero where nothing was met
  std::array<std::uint32_t, RayPacket::kSize> triangle;
};

/// Casts rays against a mesh. Holes of cut-out textures are passed. All functions may be called from several threads;
/// the same rays in the same packets give the same bytes on every machine that has AVX2.
class SceneRaycaster {
 public:
  static constexpr int kPacket = 16;  ///< rays that occluded() takes

  /// The mesh must be sound (problem_of) and outlive the caster.
  explicit SceneRaycaster(const Mesh& mesh);
  ~SceneRaycaster();
  SceneRaycaster(const SceneRaycaster&) = delete;
  SceneRaycaster& operator=(const SceneRaycaster&) = delete;

  /// First hit within `longest` lengths of the direction.
  std::optional<RayHit> cast(const Ray& ray, float longest) const;
  /// Eight rays at once, faster when they are alike.
  void cast(const RayPacket& rays, float longest, HitPacket& hits) const;
  /// Bit i is set when something lies on ray i nearer than longest[i]; at most kPacket rays.
  unsigned int occluded(std::span<const Ray> rays, std::span<const float> longest) const;

  /// Instruction set that rays are cast with: "avx2", or "default" where the machine has none.
  const char* instruction_set() const;
  const Mesh& mesh() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::simulator
