#include "simulator/core/furniture/furniture_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapis::simulator {
namespace {

void chair(Workshop& s) {
  const auto frame = s.wood(), seat = s.dice.chance(0.5) ? s.fabric() : frame;
  const float t = 0.05F, seat_z = 0.5F * s.h;
  s.legs(t, seat_z, 0.01F, frame);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, seat_z, seat_z + 0.05F, seat);
  for (const float x : {-s.w / 2, s.w / 2 - t}) s.box(x, x + t, s.d / 2 - t, s.d / 2, seat_z, s.h, frame);
  for (const float z : {0.65F, 0.8F, 0.93F})
    s.box(-s.w / 2 + t, s.w / 2 - t, s.d / 2 - 0.03F, s.d / 2 - 0.01F, z * s.h, (z + 0.07F) * s.h, seat);
}

void table(Workshop& s) {
  const auto top = s.wood();
  s.legs(0.06F, s.h - 0.04F, 0.03F, s.dice.chance(0.7) ? top : s.metal());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.04F, s.h, top);
  for (const float y : {-s.d / 2 + 0.05F, s.d / 2 - 0.07F})
    s.box(-s.w / 2 + 0.06F, s.w / 2 - 0.06F, y, y + 0.02F, s.h - 0.12F, s.h - 0.04F, top);
}

/// A carcass whose front is divided into doors or drawers with handles.
void fronts(Workshop& s, float z0, float z1, int columns, int rows, std::uint32_t front, std::uint32_t handle) {
  s.box(-s.w / 2, s.w / 2, -s.d / 2 + 0.03F, s.d / 2, z0, z1, front);
  const float width = s.w / static_cast<float>(columns), height = (z1 - z0) / static_cast<float>(rows), gap = 0.006F;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const float x = -s.w / 2 + width * static_cast<float>(column), z = z0 + height * static_cast<float>(row);
      s.box(x + gap, x + width - gap, -s.d / 2 + 0.012F, -s.d / 2 + 0.035F, z + gap, z + height - gap, front);
      const bool is_drawer = height < width;
      const float hx = is_drawer ? x + 0.5F * width : x + (column % 2 == 0 ? 0.88F : 0.12F) * width;
      const float hz = z + (is_drawer ? 0.65F : 0.5F) * height, wide = is_drawer ? 0.06F : 0.01F;
      s.box(hx - wide, hx + wide, -s.d / 2, -s.d / 2 + 0.02F, hz - 0.07F + wide, hz + 0.07F - wide, handle);
    }
  }
}

void cabinet(Workshop& s) {
  const auto front = s.wood(), handle = s.dark();
  const int columns = std::max(1, static_cast<int>(std::lround(s.w / 0.5F)));
  fronts(s, 0.06F, s.h, columns, s.h > 1.4F ? 2 : 1, front, handle);
  s.box(-s.w / 2 + 0.03F, s.w / 2 - 0.03F, -s.d / 2 + 0.06F, s.d / 2, 0.0F, 0.06F, handle);
}

void chest_of_drawers(Workshop& s) {
  const auto front = s.wood();
  fronts(s, 0.06F, s.h, s.w > 1.0F ? 2 : 1, std::max(2, static_cast<int>(s.h / 0.25F)), front, s.metal());
  s.legs(0.05F, 0.06F, 0.02F, front);
}

void counter(Workshop& s) {
  const auto front = s.wood();
  fronts(s, 0.08F, s.h - 0.04F, std::max(1, static_cast<int>(std::lround(s.w / 0.6F))), 1, front, s.metal());
  s.box(-s.w / 2 + 0.01F, s.w / 2 - 0.01F, -s.d / 2 + 0.06F, s.d / 2, 0.0F, 0.08F, s.dark());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, s.h - 0.04F, s.h, s.textured("concrete", {200, 196, 190}));
}

void cushion(Workshop& s) { s.shapes.ball({0.0F, 0.0F, s.h / 2}, {s.w / 2, s.d / 2, s.h / 2}, s.fabric()); }

/// Seat, back, arms.
void sofa(Workshop& s) {
  const auto cover = s.fabric(), legs = s.dark();
  const float arm = std::min(0.18F, 0.15F * s.w), seat = 0.55F * s.h, back = 0.28F * s.d;
  s.legs(0.05F, 0.08F, 0.04F, legs);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.08F, 0.35F * s.h, cover);
  for (const float x : {-s.w / 2, s.w / 2 - arm}) s.box(x, x + arm, -s.d / 2, s.d / 2, 0.35F * s.h, 0.72F * s.h, cover);
  s.box(-s.w / 2 + arm, s.w / 2 - arm, s.d / 2 - back, s.d / 2, 0.35F * s.h, s.h, cover);
  const int places = std::max(1, static_cast<int>(std::lround((s.w - 2 * arm) / 0.65F)));
  const float width = (s.w - 2 * arm) / static_cast<float>(places);
  for (int i = 0; i < places; ++i) {
    const float x = -s.w / 2 + arm + width * static_cast<float>(i);
    s.box(x + 0.01F, x + width - 0.01F, -s.d / 2 - 0.01F, s.d / 2 - back, 0.36F * s.h, seat, cover);
    s.box(x + 0.02F, x + width - 0.02F, s.d / 2 - back - 0.1F, s.d / 2 - back, seat, 0.95F * s.h, cover);
  }
}

void seating(Workshop& s) {
  const auto cover = s.fabric();
  s.legs(0.05F, 0.6F * s.h, 0.03F, s.metal());
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.6F * s.h, s.h, cover);
}

void bed(Workshop& s) {
  const auto frame = s.wood(), sheet = s.white(), blanket = s.fabric(), pillow = s.fabric();
  const float top = std::min(0.55F, 0.7F * s.h);
  s.legs(0.08F, 0.2F * s.h, 0.0F, frame);
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0.2F * s.h, 0.5F * top, frame);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 0.06F, s.d / 2, 0.0F, s.h, frame);
  s.box(-s.w / 2 + 0.03F, s.w / 2 - 0.03F, -s.d / 2 + 0.03F, s.d / 2 - 0.06F, 0.5F * top, 0.92F * top, sheet);
  s.box(-s.w / 2 + 0.01F, s.w / 2 - 0.01F, -s.d / 2 + 0.01F, 0.2F * s.d, 0.6F * top, top, blanket);
  const int pillows = s.w > 1.2F ? 2 : 1;
  for (int i = 0; i < pillows; ++i) {
    const float x = s.w * ((static_cast<float>(i) + 0.5F) / static_cast<float>(pillows) - 0.5F);
    s.shapes.ball({x, 0.36F * s.d, top}, {std::min(0.35F, 0.42F * s.w), 0.18F, 0.09F}, pillow);
  }
}

void plant(Workshop& s) {
  const auto leaf = s.textured("leaves"), stem = s.plain(90, 64, 40), pot = s.paint();
  const float pot_height = 0.28F * s.h;
  s.shapes.cylinder({0, 0, 0}, {0.2F * s.w, 0.2F * s.d}, {0.27F * s.w, 0.27F * s.d}, pot_height, pot);
  s.cylinder(0, 0, 0.9F * pot_height, 0.03F * s.w, 0.02F * s.w, 0.4F * s.h, stem, 6);
  for (int i = 0; i < 9; ++i) {
    const float angle = 2.4F * static_cast<float>(i), out = i == 0 ? 0.0F : 0.3F;
    const auto size = static_cast<float>(s.dice(0.13, 0.2)), height = static_cast<float>(s.dice(0.5, 0.85));
    const float z = height * s.h;
    s.shapes.ball({out * s.w * std::cos(angle), out * s.d * std::sin(angle), i == 0 ? 0.85F * s.h : z},
                  {size * s.w, size * s.d, 0.15F * s.h}, leaf, 6);
  }
}

void stool(Workshop& s) {
  const auto wood = s.wood();
  s.legs(0.04F, s.h - 0.04F, 0.05F, wood);
  s.shapes.cylinder({0, 0, s.h - 0.04F}, {s.w / 2, s.d / 2}, {s.w / 2, s.d / 2}, 0.04F, wood, 16);
}

void tv_monitor(Workshop& s) {
  const auto black = s.dark();
  const float foot = 0.1F * s.h, t = std::min(0.05F, s.d);
  s.box(-0.2F * s.w, 0.2F * s.w, -s.d / 2, s.d / 2, 0, 0.02F, black);
  s.box(-0.04F * s.w, 0.04F * s.w, 0, 0.5F * t, 0.02F, foot + 0.1F * s.h, black);
  s.box(-s.w / 2, s.w / 2, -t / 2, t / 2, foot, s.h, black);
  s.shapes.picture({-0.48F * s.w, -t / 2 - 0.003F, foot + 0.03F * s.h}, {0.96F * s.w, 0, 0}, {0, 0, 0.84F * s.h},
                   s.painting(1.6));
}

/// Books of many colours and sizes on a board; some are left out.
void books(Workshop& s, float z, float height) {
  std::array<std::uint32_t, 6> covers{};
  for (auto& cover : covers) cover = s.paint();
  float x = -s.w / 2 + 0.04F;
  while (true) {
    const auto width = static_cast<float>(s.dice(0.02, 0.05)), tall = height * static_cast<float>(s.dice(0.6, 0.95));
    if (x + width > s.w / 2 - 0.04F) break;
    const auto front = -0.4F * s.d + 0.2F * s.d * static_cast<float>(s.dice(0.0, 1.0));
    const auto cover = covers[static_cast<std::size_t>(s.dice.whole(0, 5))];
    if (s.dice.chance(0.85)) s.box(x, x + width, front, 0.4F * s.d, z, z + tall, cover);
    x += width + 0.003F;
  }
}

constexpr float kPallet_m = 0.75F;  // shelves at least this deep carry pallets; objects larger than this are pallets

/// A pallet with layers of cartons, each layer a little smaller or larger.
void pallet(Workshop& s, const Eigen::AlignedBox3f& space) {
  const Eigen::Vector3f& low = space.min();
  const Eigen::Vector3f size = space.sizes();
  const auto wood = s.plain(178, 146, 104);
  for (const float share : {0.0F, 0.43F, 0.86F})
    s.box(low.x() + share * size.x(), low.x() + (share + 0.14F) * size.x(), low.y(), low.y() + size.y(), low.z(),
          low.z() + 0.1F, wood);
  s.box(low.x(), low.x() + size.x(), low.y(), low.y() + size.y(), low.z() + 0.1F, low.z() + 0.13F, wood);
  const bool is_printed = s.dice.chance(0.4);
  const auto tone = static_cast<std::uint8_t>(s.dice.whole(150, 200));
  const auto carton = is_printed ? s.textured("clutter") : s.plain(tone, static_cast<std::uint8_t>(tone * 0.82F), 120);
  const auto label = s.painting(1.4);
  const int layers = std::max(1, static_cast<int>((size.z() - 0.13F) / 0.35F));
  const float step = (size.z() - 0.13F) / static_cast<float>(layers);
  for (int i = 0; i < layers; ++i) {
    const float inset = static_cast<float>(s.dice(0.0, 0.05)), z = low.z() + 0.13F + step * static_cast<float>(i);
    const float x0 = low.x() + inset, x1 = low.x() + size.x() - inset, middle = 0.5F * (x0 + x1);
    for (const auto& [a, b] : {std::pair{x0, middle - 0.005F}, std::pair{middle + 0.005F, x1}}) {
      s.box(a, b, low.y() + inset, low.y() + size.y() - inset, z, z + step - 0.006F, carton);
      const float wide = 0.6F * (b - a), tall = 0.6F * step, x = a + 0.1F * wide;
      s.shapes.picture({x, low.y() + inset - 0.002F, z + 0.15F * step}, {wide, 0, 0}, {0, 0, tall}, label);
      s.shapes.picture({x + wide, low.y() + size.y() - inset + 0.002F, z + 0.15F * step}, {-wide, 0, 0}, {0, 0, tall},
                       label);
    }
  }
}

/// A rack of posts and beams. Pallets stand on the floor and on its decks; some places are empty.
void pallet_rack(Workshop& s) {
  const auto post = s.plain(44, 78, 140), beam = s.plain(214, 104, 38), deck = s.metal();
  const float t = 0.09F;
  for (const float x : {-s.w / 2, s.w / 2 - t}) {
    for (const float y : {-s.d / 2, s.d / 2 - t}) s.box(x, x + t, y, y + t, 0, s.h, post);
    for (float z = 0.3F; z + 0.05F < s.h; z += 0.7F) s.box(x, x + t, -s.d / 2 + t, s.d / 2 - t, z, z + 0.05F, post);
  }
  const int levels = std::max(2, static_cast<int>(std::lround(s.h / 1.25F)));
  const float step = s.h / static_cast<float>(levels), inside = s.w - 2 * t;
  const int places = inside > 2.0F ? 3 : 2;
  const float wide = inside / static_cast<float>(places);
  for (int level = 0; level < levels; ++level) {
    const float z = step * static_cast<float>(level);
    if (level > 0) {
      for (const float y : {-s.d / 2, s.d / 2 - 0.05F})
        s.box(-s.w / 2 + t, s.w / 2 - t, y, y + 0.05F, z - 0.12F, z, beam);
      s.box(-s.w / 2 + t, s.w / 2 - t, -s.d / 2 + 0.05F, s.d / 2 - 0.05F, z - 0.03F, z, deck);
    }
    for (int i = 0; i < places; ++i) {
      const float x = -s.w / 2 + t + wide * static_cast<float>(i),
                  tall = (step - 0.16F) * static_cast<float>(s.dice(0.45, 0.95));
      if (s.dice.chance(0.12)) continue;
      pallet(s,
             {Eigen::Vector3f(x + 0.04F, -0.46F * s.d, z), Eigen::Vector3f(x + wide - 0.04F, 0.46F * s.d, z + tall)});
    }
  }
}

void shelving(Workshop& s) {
  if (s.d >= kPallet_m) return pallet_rack(s);
  const auto wood = s.wood();
  const float t = 0.025F;
  for (const float x : {-s.w / 2, s.w / 2 - t}) s.box(x, x + t, -s.d / 2, s.d / 2, 0, s.h, wood);
  s.box(-s.w / 2, s.w / 2, s.d / 2 - 0.01F, s.d / 2, 0, s.h, wood);
  const int boards = std::max(2, static_cast<int>(std::lround(s.h / 0.36F)));
  const float step = (s.h - t) / static_cast<float>(boards);
  for (int i = 0; i <= boards; ++i) {
    const float z = step * static_cast<float>(i);
    s.box(-s.w / 2 + t, s.w / 2 - t, -s.d / 2, s.d / 2, z, z + t, wood);
    if (i < boards) books(s, z + t, step - t);
  }
}

/// A treadmill.
void gym_equipment(Workshop& s) {
  const auto black = s.dark(), steel = s.metal();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.14F * s.h, black);
  s.box(-0.35F * s.w, 0.35F * s.w, -0.48F * s.d, 0.4F * s.d, 0.14F * s.h, 0.15F * s.h,
        s.textured("fabric", {60, 60, 64}));
  for (const float x : {-s.w / 2, s.w / 2 - 0.06F}) {
    s.box(x, x + 0.06F, 0.36F * s.d, 0.44F * s.d, 0.14F * s.h, 0.85F * s.h, steel);
    s.box(x, x + 0.06F, 0.05F * s.d, 0.44F * s.d, 0.66F * s.h, 0.7F * s.h, steel);
  }
  s.box(-s.w / 2, s.w / 2, 0.34F * s.d, 0.5F * s.d, 0.82F * s.h, s.h, black);
  s.shapes.picture({-0.3F * s.w, 0.335F * s.d, 0.86F * s.h}, {0.6F * s.w, 0, 0}, {0, 0, 0.1F * s.h}, s.painting(2.0));
}

/// Coats on hooks.
void clothes(Workshop& s) {
  s.box(-s.w / 2, s.w / 2, 0.3F * s.d, s.d / 2, 0.94F * s.h, s.h, s.wood());
  const int coats = std::max(1, static_cast<int>(s.w / 0.2F));
  const float width = s.w / static_cast<float>(coats);
  for (int i = 0; i < coats; ++i) {
    const float x = -s.w / 2 + width * (static_cast<float>(i) + 0.5F), r = 0.46F * width;
    const auto low = i == 0 ? 0.0F : s.h * static_cast<float>(s.dice(0.0, 0.35));
    s.shapes.cylinder({x, 0, low}, {r, s.d / 2}, {0.4F * r, 0.15F * s.d}, 0.95F * s.h - low, s.fabric(), 8);
  }
}

/// A pile of boxes with printed sides.
void objects(Workshop& s) {
  if (s.w > kPallet_m && s.d > kPallet_m && s.h > kPallet_m)
    return pallet(s, {Eigen::Vector3f(-s.w / 2, -s.d / 2, 0), Eigen::Vector3f(s.w / 2, s.d / 2, s.h)});
  const auto print = s.textured("clutter"), plain = s.paint();
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.55F * s.h, print);
  s.box(-0.4F * s.w, 0.25F * s.w, -0.4F * s.d, 0.4F * s.d, 0.55F * s.h, 0.8F * s.h, plain);
  s.cylinder(-0.1F * s.w, 0, 0.8F * s.h, 0.2F * std::min(s.w, s.d), 0.15F * std::min(s.w, s.d), 0.2F * s.h, print, 10);
}

void furniture(Workshop& s) {
  const auto wood = s.wood();
  s.legs(0.05F, 0.3F * s.h, 0.01F, wood);
  fronts(s, 0.3F * s.h, s.h, 1, 2, wood, s.metal());
}

void rug(Workshop& s) {
  s.box(-s.w / 2, s.w / 2, -s.d / 2, s.d / 2, 0, 0.7F * s.h, s.fabric());
  s.shapes.picture({-0.48F * s.w, -0.48F * s.d, s.h}, {0.96F * s.w, 0, 0}, {0, 0.96F * s.d, 0}, s.painting(s.w / s.d));
}

constexpr std::array kMovableClasses{
    FurnitureClass{"chair", 0.46, 0.52, 0.9, chair},
    FurnitureClass{"table", 1.4, 0.8, 0.74, table},
    FurnitureClass{"cabinet", 1.0, 0.45, 1.2, cabinet},
    FurnitureClass{"cushion", 0.42, 0.42, 0.16, cushion},
    FurnitureClass{"sofa", 1.9, 0.88, 0.8, sofa},
    FurnitureClass{"bed", 1.6, 2.05, 0.95, bed},
    FurnitureClass{"chest_of_drawers", 0.9, 0.45, 0.85, chest_of_drawers},
    FurnitureClass{"plant", 0.5, 0.5, 1.1, plant},
    FurnitureClass{"stool", 0.36, 0.36, 0.46, stool},
    FurnitureClass{"tv_monitor", 1.0, 0.22, 0.65, tv_monitor},
    FurnitureClass{"counter", 1.8, 0.6, 0.9, counter},
    FurnitureClass{"shelving", 0.9, 0.3, 1.9, shelving},
    FurnitureClass{"gym_equipment", 0.75, 1.7, 1.35, gym_equipment},
    FurnitureClass{"seating", 1.1, 0.42, 0.46, seating},
    FurnitureClass{"furniture", 0.6, 0.4, 0.6, furniture},
    FurnitureClass{"clothes", 0.8, 0.25, 1.1, clothes},
    FurnitureClass{"objects", 0.3, 0.22, 0.3, objects},
    FurnitureClass{"floor", 2.0, 1.4, 0.01, rug},
};

}  // namespace

std::span<const FurnitureClass> movable_classes() { return kMovableClasses; }

}  // namespace lapis::simulator
