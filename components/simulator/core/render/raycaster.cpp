#include "simulator/core/render/raycaster.hpp"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "simulator/core/render/avx2.hpp"
#include "simulator/core/render/texel.hpp"

// Only this file uses Embree, version 3 or 4.
namespace lapis::simulator {
namespace {

constexpr int kN = SceneRaycaster::kPacket;
constexpr unsigned int kOpaque = 0;  // geometry of triangles without holes
constexpr unsigned int kCutOut = 1;  // geometry of triangles that may have holes

#if RTC_VERSION_MAJOR >= 4
void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray); }
void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &rays, &arguments);
}
void occlude(RTCScene scene, const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene, &rays); }
#else
void intersect(RTCScene scene, RTCRayHit& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
}
void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &rays);
}
void occlude(RTCScene scene, const int* valid, RTCRay16& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, scene, &context, &rays);
}
#endif

}  // namespace

struct SceneRaycaster::Implementation {
  const Mesh& mesh;
  bool is_reproducible = has_avx2();
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::array<std::vector<std::uint32_t>, 2> triangle_of;  // by geometry and primitive

  explicit Implementation(const Mesh& mesh_) : mesh(mesh_) {
    device = rtcNewDevice(is_reproducible ? "threads=1,isa=avx2" : "threads=1");
    if (device == nullptr) throw std::runtime_error("Embree cannot make a device");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const bool may_have_holes = mesh.materials[mesh.triangles[i].material].is_cut_out;
      triangle_of[may_have_holes ? kCutOut : kOpaque].push_back(i);
    }
    for (const unsigned int id : {kOpaque, kCutOut}) {
      if (!triangle_of[id].empty()) attach(id);
    }
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot index the mesh");
  }
  ~Implementation() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void attach(unsigned int id) {
    const auto& triangles = triangle_of[id];
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<Eigen::Vector3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Eigen::Vector3f), mesh.positions.size()));
    auto* indices = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(std::array<std::uint32_t, 3>), triangles.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    for (std::size_t i = 0; i < triangles.size(); ++i) indices[i] = mesh.triangles[triangles[i]].vertices;
    if (id == kCutOut) {
      rtcSetGeometryUserData(geometry, this);
      rtcSetGeometryIntersectFilterFunction(geometry, pass_holes);
      rtcSetGeometryOccludedFilterFunction(geometry, pass_holes);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }

  static void pass_holes(const RTCFilterFunctionNArguments* arguments) {
    const auto& self = *static_cast<const Implementation*>(arguments->geometryUserPtr);
    for (unsigned int i = 0; i < arguments->N; ++i) {
      if (arguments->valid[i] == 0) continue;
      const unsigned int primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
      const float u = RTCHitN_u(arguments->hit, arguments->N, i), v = RTCHitN_v(arguments->hit, arguments->N, i);
      if (is_hole(self.mesh, self.triangle_of[kCutOut][primitive], u, v)) arguments->valid[i] = 0;
    }
  }
};

SceneRaycaster::SceneRaycaster(const Mesh& mesh) : implementation_(std::make_unique<Implementation>(mesh)) {}
SceneRaycaster::~SceneRaycaster() = default;

const char* SceneRaycaster::instruction_set() const { return implementation_->is_reproducible ? "avx2" : "default"; }
const Mesh& SceneRaycaster::mesh() const { return implementation_->mesh; }

std::optional<RayHit> SceneRaycaster::cast(const Ray& ray, float longest) const {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tfar = longest;
  query.ray.mask = std::numeric_limits<unsigned int>::max();
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(implementation_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return RayHit{query.ray.tfar, implementation_->triangle_of[query.hit.geomID][query.hit.primID], query.hit.u,
                query.hit.v};
}

namespace {

template <class Packet>
void fill(Packet& packet, int i, const Ray& ray, float longest) {
  packet.org_x[i] = ray.origin.x();
  packet.org_y[i] = ray.origin.y();
  packet.org_z[i] = ray.origin.z();
  packet.dir_x[i] = ray.direction.x();
  packet.dir_y[i] = ray.direction.y();
  packet.dir_z[i] = ray.direction.z();
  packet.tnear[i] = 0.0F;
  packet.tfar[i] = longest;
  packet.time[i] = 0.0F;
  packet.mask[i] = std::numeric_limits<unsigned int>::max();
  packet.id[i] = 0;
  packet.flags[i] = 0;
}

}  // namespace

void SceneRaycaster::cast(const RayPacket& rays, float longest, HitPacket& hits) const {
  constexpr int kSize = RayPacket::kSize;
  alignas(32) RTCRayHit8 query;
  alignas(32) std::array<int, kSize> valid;
  valid.fill(-1);
  std::fill_n(query.ray.org_x, kSize, rays.origin.x());
  std::fill_n(query.ray.org_y, kSize, rays.origin.y());
  std::fill_n(query.ray.org_z, kSize, rays.origin.z());
  std::copy(rays.x.begin(), rays.x.end(), query.ray.dir_x);
  std::copy(rays.y.begin(), rays.y.end(), query.ray.dir_y);
  std::copy(rays.z.begin(), rays.z.end(), query.ray.dir_z);
  std::fill_n(query.ray.tnear, kSize, 0.0F);
  std::fill_n(query.ray.tfar, kSize, longest);
  std::fill_n(query.ray.time, kSize, 0.0F);
  std::fill_n(query.ray.mask, kSize, std::numeric_limits<unsigned int>::max());
  std::fill_n(query.ray.id, kSize, 0U);
  std::fill_n(query.ray.flags, kSize, 0U);
  std::fill_n(query.hit.geomID, kSize, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(query.hit.instID[0], kSize, RTC_INVALID_GEOMETRY_ID);
  intersect(implementation_->scene, valid.data(), query);
  for (std::size_t i = 0; i < std::size_t{kSize}; ++i) {
    const unsigned int geometry = query.hit.geomID[i];
    const bool is_met = geometry != RTC_INVALID_GEOMETRY_ID;
    hits.distance[i] = is_met ? query.ray.tfar[i] : 0.0F;
    hits.u[i] = is_met ? query.hit.u[i] : 0.0F;
    hits.v[i] = is_met ? query.hit.v[i] : 0.0F;
    hits.triangle[i] = is_met ? implementation_->triangle_of[geometry][query.hit.primID[i]] : RayHit::kNone;
  }
}

unsigned int SceneRaycaster::occluded(std::span<const Ray> rays, std::span<const float> longest) const {
  alignas(64) RTCRay16 query;
  alignas(64) std::array<int, kN> valid;
  for (int i = 0; i < kN; ++i) {
    const auto index = static_cast<std::size_t>(i);
    valid[index] = index < rays.size() ? -1 : 0;
    fill(query, i, index < rays.size() ? rays[index] : Ray{}, index < rays.size() ? longest[index] : 0.0F);
  }
  occlude(implementation_->scene, valid.data(), query);
  unsigned int result = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(rays.size(), kN); ++i) {
    if (query.tfar[i] < 0.0F) result |= 1U << i;
  }
  return result;
}

}  // namespace lapis::simulator
