#include "simulator/core/building/build_scene.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/building/lamps.hpp"
#include "simulator/core/building/placement.hpp"
#include "simulator/core/building/structure.hpp"
#include "simulator/core/furniture/parametric_furniture.hpp"
#include "simulator/core/looks/shapes.hpp"
#include "simulator/core/looks/textures.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

template <class Value>
void add_once(std::vector<Value>& list, const Value& value) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

/// Steps of build_scene that share the scene and its textures.
class SceneBuilder {
 public:
  SceneBuilder(const SceneSpec& spec, const FurnitureSource& source, const BuildOptions& options)
      : spec_(normalised(spec)), plan_(plan_walls(spec_)), source_(source), options_(options),
        structure_textures_(options.texture_richness) {}

  Scene build() && {
    describe();
    add_structure(scene_, spec_, plan_, structure_textures_);
    add_furniture();
    add_pictures();
    for (const LampSpec& lamp : lamps_of(spec_)) add_lamp(scene_, spec_, lamp);
    return std::move(scene_);
  }

 private:
  void describe() {
    scene_.name = spec_.name;
    scene_.labels = spec_.labels;
    scene_.starts = spec_.starts;
    scene_.tour = spec_.tour;
    scene_.is_stress = spec_.is_stress;
    for (std::size_t i = 0; i < spec_.rooms.size(); ++i) {
      const RoomSpec& room = spec_.rooms[i];
      scene_.rooms.push_back({room.id, room.type, room.polygon, plan_[i].height_m});
    }
  }

  /// The model of an item, fitted to the size that the spec gives.
  SourcedModel model_of(const FurnitureSpec& item) {
    SourcedModel model;
    if (const auto found = item.model.empty() ? std::nullopt : sourced(item)) {
      model = *found;
      if (item.size_m) fit_to_box(model.mesh, *item.size_m);
    } else {
      const Eigen::Vector3d size_m = item.size_m.value_or(default_size_m(item.class_name));
      model.mesh = make_furniture(item.class_name, size_m, item.variant, furniture_textures_);
    }
    return model;
  }

  std::optional<SourcedModel> sourced(const FurnitureSpec& item) {
    if (!source_) {
      add_once(scene_.warnings, std::string("no furniture catalogue: parametric furniture stands in "
                                            "(remedy: apt install sweethome3d-furniture)"));
      return std::nullopt;
    }
    auto answer = source_(item);
    if (const auto* refusal = std::get_if<SourceRefusal>(&answer)) {
      add_once(scene_.warnings, refusal->reason);
      return std::nullopt;
    }
    auto& model = std::get<SourcedModel>(answer);
    for (const auto& warning : model.warnings) add_once(scene_.warnings, warning);
    if (model.credit) add_once(scene_.credits, *model.credit);
    warn_of_unknown_parts(item, model);
    return std::move(model);
  }

  void warn_of_unknown_parts(const FurnitureSpec& item, const SourcedModel& model) {
    for (const auto& entry : item.parts) {
      const std::string& name = entry.first;
      const auto& materials = model.mesh.materials;
      const bool is_known =
          std::any_of(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; }) ||
          std::find(model.groups.begin(), model.groups.end(), name) != model.groups.end();
      if (!is_known) add_once(scene_.warnings, "item \"" + item.id + "\": " + item.model + " has no part " + name);
    }
  }

  void add_furniture() {
    std::vector<SourcedModel> models;
    std::vector<ItemExtent> extents;
    std::size_t triangles = 0;
    for (const FurnitureSpec& item : spec_.furniture) {
      const SourcedModel& model = models.emplace_back(model_of(item));
      triangles += model.mesh.triangles.size();
      if (triangles > kMaxTriangles) refuse(spec_, "furniture", "has more than 20 million triangles; remove some");
      const bool is_on_item = std::holds_alternative<OnItem>(item.place);
      const double usual = is_on_item ? 0.0 : model.elevation_m;
      extents.push_back({bounds(model.mesh).sizes().cast<double>(), item.elevation_m.value_or(usual)});
    }
    const auto poses = options_.with_jitter ? place_furniture_with_jitter(spec_, plan_, extents, options_.seed)
                                            : place_furniture(spec_, plan_, extents);
    for (std::size_t i = 0; i < models.size(); ++i) add_item(spec_.furniture[i], models[i], poses[i].T_world_item());
  }

  /// Adds one instance, and another one for every further class that the item's parts have.
  void add_item(const FurnitureSpec& item, const SourcedModel& model, const Eigen::Affine3f& T_world_item) {
    const std::size_t first = scene_.mesh.triangles.size();
    std::map<std::string, std::uint32_t> part_of_class{
        {item.class_name, add_instance(scene_, item.class_name, item.id)}};
    append(scene_.mesh, model.mesh, T_world_item, part_of_class.at(item.class_name));
    if (item.parts.empty()) return;
    const auto class_of = [&](const Triangle& triangle) {
      auto found = item.parts.find(model.mesh.materials[triangle.material].name);
      if (found == item.parts.end() && triangle.part < model.groups.size())
        found = item.parts.find(model.groups[triangle.part]);
      return found == item.parts.end() ? item.class_name : found->second;
    };
    for (std::size_t i = 0; i < model.mesh.triangles.size(); ++i) {
      const std::string name = class_of(model.mesh.triangles[i]);
      if (!part_of_class.contains(name)) part_of_class[name] = add_instance(scene_, name, item.id + "/" + name);
      scene_.mesh.triangles[first + i].part = part_of_class[name];
    }
  }

  void add_pictures() {
    const auto places =
        options_.with_jitter ? place_pictures_with_jitter(spec_, plan_, options_.seed) : place_pictures(spec_, plan_);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Random random(options_.seed, RandomStream::kPictures, *spec_.pictures[i].motif);
      if (spec_.pictures[i].class_name == "picture" && random.uniform(1) >= options_.pictures_density) continue;
      add_picture(i, places[i]);
    }
  }

  std::shared_ptr<const TextureImage> face_of(const PictureSpec& picture) {
    if (picture.class_name == "mirror") return furniture_textures_.surface("mirror", *picture.motif);
    const double aspect = picture.size_m.x() / picture.size_m.y();
    return std::make_shared<const TextureImage>(make_picture(*picture.motif, aspect, options_.texture_richness));
  }

  /// Adds a flat face on a board that is 2 cm thick and whose rim of 3 cm is the frame.
  void add_picture(std::size_t index, double along_m) {
    constexpr float kRim_m = 0.03F, kThickness_m = 0.02F, kGap_m = 0.002F;
    constexpr std::array<geometry::Rgb8, 4> kFrames{{{60, 44, 34}, {186, 150, 90}, {232, 230, 224}, {40, 40, 44}}};
    const PictureSpec& picture = spec_.pictures[index];
    const Wall& wall = plan_[room_index(spec_, picture.room)].walls[static_cast<std::size_t>(picture.edge)];
    Shapes shapes(scene_.mesh);
    shapes.T_mesh_shape = wall.T_world_wall();
    shapes.part = add_instance(scene_, picture.class_name, picture.room + "/" + numbered("picture", index));
    const Eigen::Vector2f half = (0.5 * picture.size_m).cast<float>();
    const auto x = static_cast<float>(along_m), z = static_cast<float>(picture.height_m);
    const float x0 = x - half.x(), x1 = x + half.x(), z0 = z - half.y(), z1 = z + half.y();
    shapes.box({x0, kGap_m, z0}, {x1, kThickness_m, z1},
               shapes.material("frame", kFrames[*picture.motif % kFrames.size()]));
    // The face is in front of the frame, because behind its rim it would be dark.
    shapes.picture({x1 - kRim_m, kThickness_m + 0.001F, z0 + kRim_m}, {x0 - x1 + 2 * kRim_m, 0, 0},
                   {0, 0, z1 - z0 - 2 * kRim_m}, shapes.material("face", {255, 255, 255}, face_of(picture)));
  }

  const SceneSpec spec_;
  const std::vector<RoomPlan> plan_;
  const FurnitureSource& source_;
  const BuildOptions& options_;
  TextureLibrary structure_textures_, furniture_textures_;
  Scene scene_;
};

}  // namespace

Scene build_scene(const SceneSpec& spec, const FurnitureSource& furniture, const BuildOptions& options) {
  return SceneBuilder(spec, furniture, options).build();
}

}  // namespace lapis::simulator
