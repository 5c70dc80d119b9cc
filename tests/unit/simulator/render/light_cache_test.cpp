#include "simulator/core/render/light_cache.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include "box_scene.hpp"
#include "common/files/crc32.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::simulator {
namespace {

namespace fs = std::filesystem;

Scene lit_box() {
  Scene scene = test::box_scene();
  scene.lamps.push_back({{2.0F, 1.5F, 2.0F}, 1.0F});
  return scene;
}

std::vector<std::uint8_t> light_of(const Scene& scene, const fs::path& folder) {
  const SceneRaycaster raycaster(scene.mesh);
  return cached_light(scene, raycaster, 1, folder);
}

std::vector<std::uint8_t> bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream stream(file, std::ios::binary);
  for (const std::uint8_t byte : bytes) stream.put(static_cast<char>(byte));
}

class LightCache : public testing::Test {
 protected:
  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path());
    return names;
  }

 private:
  lapis::test::TemporaryFolder temporary_;

 protected:
  const fs::path folder_ = temporary_.path();
};

TEST_F(LightCache, ReadsWhatItKept) {
  const auto baked = light_of(lit_box(), {});
  EXPECT_EQ(light_of(lit_box(), folder_), baked);
  ASSERT_EQ(files().size(), 1U);
  const fs::path file = *files().begin();
  auto changed = baked;
  changed[5] ^= 1U;
  auto bytes = changed;
  bytes.resize(bytes.size() + 4);
  const std::uint32_t checksum = files::crc32(changed);
  std::memcpy(bytes.data() + changed.size(), &checksum, 4);
  write(file, bytes);
  EXPECT_EQ(light_of(lit_box(), folder_), changed);
}

TEST_F(LightCache, DamageCostsTimeOnly) {
  const auto baked = light_of(lit_box(), folder_);
  const fs::path file = *files().begin();
  const auto whole = bytes_of(file);
  for (const std::size_t size : {std::size_t{0}, std::size_t{3}, whole.size() - 1}) {
    write(file, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    EXPECT_EQ(light_of(lit_box(), folder_), baked);
    EXPECT_EQ(bytes_of(file), whole);
  }
}

TEST_F(LightCache, WhatChangesLightHasAFileOfItsOwn) {
  Scene scene = lit_box();
  light_of(scene, folder_);
  scene.lamps[0].intensity = 0.5F;
  light_of(scene, folder_);
  scene.mesh.positions[0].x() -= 0.1F;
  light_of(scene, folder_);
  EXPECT_EQ(files().size(), 3U);
  scene.mesh.materials[0].color = {1, 2, 3};
  scene.tour.emplace_back(1, 1);
  light_of(scene, folder_);
  EXPECT_EQ(files().size(), 3U) << "light does not depend on colours or paths";
}

TEST_F(LightCache, KeepsTheNewest) {
  const auto now = fs::file_time_type::clock::now();
  const auto put = [&](const std::string& name, std::uintmax_t mebibytes, int age_min) {
    write(folder_ / name, {});
    fs::resize_file(folder_ / name, mebibytes << 20U);  // sparse
    fs::last_write_time(folder_ / name, now - std::chrono::minutes(age_min));
  };
  put("a.light", 100, 1);
  put("b.light", 100, 2);
  put("c.light", 100, 3);
  put("d.light", 1, 4);
  put("notes.txt", 300, 5);
  light_of(lit_box(), folder_);
  EXPECT_TRUE(fs::exists(folder_ / "a.light"));
  EXPECT_TRUE(fs::exists(folder_ / "b.light"));
  EXPECT_FALSE(fs::exists(folder_ / "c.light"));
  EXPECT_FALSE(fs::exists(folder_ / "d.light"));
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt")) << "not ours";
  EXPECT_EQ(files().size(), 4U) << "and the new one";
}

TEST(SceneHash, CoversWhatARunTakesFromAScene) {
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene&) {},
      [](Scene& s) { s.floor_z_m = 0.1; },
      [](Scene& s) { s.is_lit = false; },
      [](Scene& s) { s.rooms[0].polygon[1].x() += 0.5; },
      [](Scene& s) { s.rooms[0].type = "kitchen"; },
      [](Scene& s) { s.starts[0].yaw_rad = 1.0; },
      [](Scene& s) { s.starts.clear(); },
      [](Scene& s) { s.tour[0].y() = 2.0; },
      [](Scene& s) { s.lamps[0].intensity = 2.0F; },
      [](Scene& s) {
        s.mesh.materials[0].color = {1, 2, 3};
      },
      [](Scene& s) { s.instances[2].class_id = 9; },
  };
  std::set<std::uint64_t> hashes;
  for (const auto& change : changes) {
    Scene scene = lit_box();
    scene.rooms = {{"box", "living", {{0, 0}, {4, 0}, {4, 3}, {0, 3}}, 2.5}};
    scene.starts = {{{2.0, 1.5}, 0.0}};
    scene.tour = {{1.0, 1.0}};
    change(scene);
    hashes.insert(scene_hash(scene));
  }
  EXPECT_EQ(hashes.size(), changes.size());
}

}  // namespace
}  // namespace lapis::simulator
