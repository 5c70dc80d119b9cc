#include "simulator/core/validation/content_checks.hpp"

#include <algorithm>
#include <map>

#include "simulator/core/truth/mesh_voxels.hpp"
#include "simulator/core/validation/overlap.hpp"
#include "simulator/core/validation/support.hpp"

namespace lapis::simulator {
namespace {

constexpr double kVoxel_m = 0.1;
constexpr std::size_t kLeastVoxels = 50;  // about half a square metre
constexpr std::size_t kLeastClasses = 16;

std::string at(const Eigen::Vector3f& p) {
  return "(" + decimal(p.x(), 2) + ", " + decimal(p.y(), 2) + ", " + decimal(p.z(), 2) + ")";
}

std::string percent(double share) { return decimal(100.0 * share, 0) + " %"; }

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Check with_details(std::string name, const std::string& figures, std::vector<std::string> offenders) {
  return {std::move(name), offenders.empty() ? Verdict::kOk : Verdict::kFail, figures, std::move(offenders)};
}

struct ClassCount {
  std::size_t items = 0, triangles = 0, voxels = 0;
};

}  // namespace

Check check_floating(const Scene& scene, const Inventory& inventory) {
  std::vector<std::string> offenders;
  for (const std::size_t i : find_floating(scene, inventory)) {
    const Item& item = inventory.items[i];
    const Eigen::Vector3f foot(item.box.center().x(), item.box.center().y(), item.box.min().z());
    offenders.push_back(item.name + ": nothing holds it; its lowest point is at " + at(foot));
  }
  const std::string figures = std::to_string(offenders.size()) + " of " + counted(inventory.items.size(), "item");
  return with_details("floating", figures, std::move(offenders));
}

Check check_overlaps(const Scene& scene, const Inventory& inventory) {
  std::vector<std::string> offenders;
  for (const Overlap& pair : find_overlaps(scene, inventory)) {
    offenders.push_back(inventory.items[pair.first].name + " - " + inventory.items[pair.second].name + ": share " +
                        percent(pair.share) + " of the smaller one, around " + at(pair.at));
  }
  const std::string figures = counted(offenders.size(), "pair");
  return with_details("overlaps", figures, std::move(offenders));
}

Check check_walls(const Scene& scene, const Inventory& inventory) {
  if (scene.rooms.empty()) return {"walls", Verdict::kNote, "the scene knows no rooms", {}};
  std::vector<std::string> offenders;
  for (const Protrusion& out : find_protrusions(scene, inventory)) {
    const Item& item = inventory.items[out.item];
    offenders.push_back(item.name + " at " + at(item.box.center()) + ": " + percent(out.share) +
                        " of its surface is outside of the rooms");
  }
  const std::string figures = counted(offenders.size(), "item") + " leave the rooms";
  return with_details("walls", figures, std::move(offenders));
}

Check list_panes(const Scene& scene) {
  constexpr float kSill_m = 0.3F;
  std::vector<Eigen::AlignedBox3f> boxes(scene.instances.size());
  for (const Triangle& t : scene.mesh.triangles) {
    for (const std::uint32_t vertex : t.vertices) boxes[t.part].extend(scene.mesh.positions[vertex]);
  }
  Check check{"panes"};
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::string name = scene.labels.name(scene.instances[i].class_id);
    if (boxes[i].isEmpty() || (name != "window" && name != "mirror")) continue;
    if (boxes[i].min().z() > static_cast<float>(scene.floor_z_m) + kSill_m) continue;
    check.details.push_back(scene.instances[i].name + ": " + name + " at " + at(boxes[i].center()));
  }
  if (!check.details.empty()) check.verdict = Verdict::kNote;
  check.figures = std::to_string(check.details.size()) + " windows and mirrors without a sill";
  return check;
}

Check count_classes(const Scene& scene, const Inventory& inventory) {
  std::map<std::uint16_t, ClassCount> classes;
  for (const Item& item : inventory.items) ++classes[item.class_id].items;
  for (const Triangle& t : scene.mesh.triangles) ++classes[scene.instances[t.part].class_id].triangles;
  const auto T = geometry::Pose::Identity();
  for (const SurfaceVoxel& voxel : surface_voxels(scene, T, voxel_box(scene, T, kVoxel_m)))
    ++classes[voxel.label].voxels;
  Check check{"classes"};
  std::size_t seen = 0;
  for (const auto& [id, count] : classes) {
    if (id != 0 && count.voxels >= kLeastVoxels) ++seen;
    check.details.push_back(scene.labels.name(id) + ": " + counted(count.items, "item") + ", " +
                            counted(count.triangles, "triangle") + ", " + counted(count.voxels, "voxel") + " of " +
                            decimal(kVoxel_m, 1) + " m");
  }
  const auto pictures = std::count_if(inventory.items.begin(), inventory.items.end(),
                                      [&](const Item& item) { return scene.labels.name(item.class_id) == "picture"; });
  check.verdict = seen >= kLeastClasses ? Verdict::kOk : Verdict::kNote;
  check.figures = counted(inventory.items.size(), "item") + ", " +
                  counted(static_cast<std::size_t>(pictures), "picture") + " among them; " +
                  std::to_string(classes.size()) + " classes, " + std::to_string(seen) + " of them with at least " +
                  std::to_string(kLeastVoxels) + " voxels";
  return check;
}

}  // namespace lapis::simulator
