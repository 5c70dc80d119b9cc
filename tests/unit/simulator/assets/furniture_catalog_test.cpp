#include "simulator/core/assets/furniture_catalog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "unit/simulator/assets/asset_files.hpp"

namespace lapis::simulator {
namespace {

using test::error_of;
using test::to_bytes;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kProperties =
    "id=Test\nlicense=CC-BY \xA9 someone\n"
    "id#2=Test#stool\nname#2=Stool\ncategory#2=Kitchen\nmodel#2=/test/stool.obj\n"
    "width#2=40\ndepth#2=30.5\nheight#2=50\n"
    "id#10=Test#lamp\nname#10=Lampe d'\\u00e9t\\u00e9\ncategory#10=Lights\nmodel#10=/test/lamp.obj\n"
    "width#10=20\ndepth#10=10\nheight#10=100\nelevation#10=150.5\ndropOnTopElevation#10=-1\nmovable#10=false\n"
    "doorOrWindow#10=true\ncreator#10=A. Author\nmodelRotation#10=1 0 0 0 0 1 0 -1 0\n"
    "id#1=Test#box\nname#1=Box\ncategory#1=Office\nmodel#1=/test/box.obj\nwidth#1=60\ndepth#1=80\nheight#1=100\n"
    "dropOnTopElevation#1=90\n";

// Corners only; raw extents 2 (x), 4 (y, up), 8 (z, front), with a mark in front (+z) and one on the right (+x).
constexpr const char* kBox =
    "v 1 1 1\nv 3 1 1\nv 1 5 1\nv 1 1 9\nv 3 5 9\nusemtl mark\ng front\nf 1 2 4\ng back\nf 1 2 3\nf 2 3 5\n";

TEST(ParseCatalog, ReadsEntriesInTheOrderOfTheirNumbers) {
  const auto entries = parse_catalog(to_bytes(kProperties), "x.sh3f");
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].id, "Test#box");
  EXPECT_EQ(entries[0].top_m, 0.9);
  EXPECT_EQ(entries[1].id, "Test#stool");
  EXPECT_TRUE(entries[1].size_m.isApprox(Eigen::Vector3d(0.4, 0.305, 0.5)));
  EXPECT_TRUE(entries[1].is_movable);
  EXPECT_FALSE(entries[1].is_door_or_window);
  EXPECT_TRUE(entries[1].model_rotation.isIdentity());
  const CatalogEntry& lamp = entries[2];
  EXPECT_EQ(lamp.name, "Lampe d'été");
  EXPECT_EQ(lamp.category, "Lights");
  EXPECT_EQ(lamp.model, "test/lamp.obj");
  EXPECT_EQ(lamp.creator, "A. Author");
  EXPECT_EQ(lamp.licence, "CC-BY © someone");
  EXPECT_DOUBLE_EQ(lamp.elevation_m, 1.505);
  EXPECT_EQ(lamp.top_m, std::nullopt) << "nothing can be put on it";
  EXPECT_FALSE(lamp.is_movable);
  EXPECT_TRUE(lamp.is_door_or_window);
  EXPECT_TRUE((lamp.model_rotation * Eigen::Vector3f::UnitZ()).isApprox(Eigen::Vector3f::UnitY())) << "z up -> y up";
}

TEST(ParseCatalog, NamesFileAndKeyOfABadValue) {
  const std::string good = kProperties;
  for (const auto* key : {"name#2", "category#2", "model#2", "width#2", "height#10"}) {
    std::string bad = good;
    bad.insert(bad.find(key), "x");
    EXPECT_THAT(error_of([&] { parse_catalog(to_bytes(bad), "x.sh3f"); }),
                AllOf(HasSubstr("x.sh3f: "), HasSubstr(key), HasSubstr("remove")));
  }
  for (const auto* line : {"width#2=wide", "depth#2=0", "height#2=-3", "width#2=nan", "elevation#2=high",
                           "modelRotation#2=1 0 0 0 1 0 0 0", "modelRotation#2=1 0 0 0 1 0 0 0 inf"})
    EXPECT_THAT(error_of([&] { parse_catalog(to_bytes(good + line), "x.sh3f"); }), HasSubstr("#2 ")) << line;
}

class FurnitureCatalogTest : public ::testing::Test {
 protected:
  void write_library(const std::string& name, const std::string& properties, const std::string& box = kBox) {
    test::write_zip(folder_.path() / name, {{"PluginFurnitureCatalog.properties", to_bytes(properties)},
                                            {"test/box.obj", to_bytes(box)},
                                            {"test/lamp.obj", to_bytes(box)}});
  }

  std::string refusal(const FurnitureCatalog& catalog, const std::string& id) {
    const auto loaded = catalog.load(*catalog.find(id));
    const auto* const reason = std::get_if<FurnitureRefusal>(&loaded);
    return reason == nullptr ? "" : reason->reason;
  }

  test::TemporaryFolder folder_;
};

TEST_F(FurnitureCatalogTest, AFolderWithoutLibrariesIsEmpty) {
  EXPECT_TRUE(FurnitureCatalog("/nowhere/at/all").empty());
  test::write_file(folder_.path() / "readme.txt", to_bytes("x"));
  const FurnitureCatalog catalog(folder_.path());
  EXPECT_TRUE(catalog.empty());
  EXPECT_EQ(catalog.find("Test#box"), nullptr);
}

TEST_F(FurnitureCatalogTest, TheFirstLibraryWithAnIdCounts) {
  write_library("b.sh3f", kProperties);
  write_library("a.sh3f", "id#1=Test#box\nname#1=First\ncategory#1=c\nmodel#1=m\nwidth#1=1\ndepth#1=1\nheight#1=1\n");
  const FurnitureCatalog catalog(folder_.path());
  std::vector<std::string> names;
  for (const auto* entry : catalog.entries()) names.push_back(entry->name);
  EXPECT_THAT(names, ElementsAre("First", "Stool", "Lampe d'été"));
  EXPECT_EQ(catalog.find("Test#box")->name, "First");
}

TEST_F(FurnitureCatalogTest, BrokenLibrariesAreErrorsThatNameThem) {
  const auto error = [&] { return error_of([&] { const FurnitureCatalog catalog(folder_.path()); }); };
  test::write_zip(folder_.path() / "a.sh3f", {{"other", {}}});
  EXPECT_THAT(error(), AllOf(HasSubstr("a.sh3f"), HasSubstr("PluginFurnitureCatalog.properties")));
  test::write_file(folder_.path() / "a.sh3f", to_bytes("no zip"));
  EXPECT_THAT(error(), HasSubstr("a.sh3f"));
  write_library("a.sh3f", "id#1=x");
  EXPECT_THAT(error(), AllOf(HasSubstr("a.sh3f"), HasSubstr("name#1")));
}

// Centre of a group's triangles.
Eigen::Vector3f centre_of(const Model& model, const std::string& group) {
  const auto part = std::find(model.groups.begin(), model.groups.end(), group) - model.groups.begin();
  Eigen::AlignedBox3f box;
  for (const auto& triangle : model.mesh.triangles) {
    if (triangle.part != part) continue;
    for (const auto vertex : triangle.vertices) box.extend(model.mesh.positions[vertex]);
  }
  return box.center();
}

TEST_F(FurnitureCatalogTest, ModelsStandInTheItemFrame) {
  write_library("a.sh3f", kProperties);
  const FurnitureCatalog catalog(folder_.path());
  const auto loaded = catalog.load(*catalog.find("Test#box"));
  const auto& model = std::get<Model>(loaded);
  const auto box = bounds(model.mesh);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(-0.3F, -0.4F, 0), 1e-5F)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(0.3F, 0.4F, 1), 1e-5F)) << box.max().transpose();
  EXPECT_EQ(model.mesh.materials.at(0).name, "mark");
  // File vertices 1, 2, 4 have z = 1 ... 9 and y = 1: the bottom; 5 is the front top right corner.
  const auto& positions = model.mesh.positions;
  EXPECT_TRUE(std::any_of(positions.begin(), positions.end(), [](const Eigen::Vector3f& p) {
    return p.isApprox(Eigen::Vector3f(0.3F, -0.4F, 1.0F), 1e-5F);
  })) << "right, front (-y), top";
  EXPECT_NEAR(centre_of(model, "front").z(), 0.0F, 1e-5F);
}

TEST_F(FurnitureCatalogTest, TheCatalogueTurnsModelsFirst) {
  write_library("a.sh3f", kProperties);
  const FurnitureCatalog catalog(folder_.path());
  const auto loaded = catalog.load(*catalog.find("Test#lamp"));
  const auto& mesh = std::get<Model>(loaded).mesh;
  EXPECT_TRUE(bounds(mesh).sizes().isApprox(Eigen::Vector3f(0.2F, 0.1F, 1.0F), 1e-5F));
  // The file's z (1 ... 9) is up now; its y (1 ... 5) points to the back.
  const auto top = std::max_element(mesh.positions.begin(), mesh.positions.end(),
                                    [](const auto& a, const auto& b) { return a.z() - a.y() < b.z() - b.y(); });
  EXPECT_TRUE(top->isApprox(Eigen::Vector3f(-0.1F, -0.05F, 1.0F), 1e-5F)) << top->transpose();
}

TEST_F(FurnitureCatalogTest, AFlatModelStaysFlat) {
  write_library("a.sh3f", kProperties, "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
  const FurnitureCatalog catalog(folder_.path());
  const auto loaded = catalog.load(*catalog.find("Test#box"));
  EXPECT_TRUE(bounds(std::get<Model>(loaded).mesh).sizes().isApprox(Eigen::Vector3f(0.6F, 0.8F, 0), 1e-5F));
}

TEST_F(FurnitureCatalogTest, RefusalsSayWhy) {
  std::string heavy = kBox;
  for (std::size_t i = 0; i <= FurnitureCatalog::kMaxTriangles; ++i) heavy += "f 1 2 3\n";
  write_library("a.sh3f", kProperties, heavy);
  const FurnitureCatalog catalog(folder_.path());
  EXPECT_THAT(refusal(catalog, "Test#box"), AllOf(HasSubstr("Test#box"), HasSubstr("more than 60000")));
  EXPECT_THAT(refusal(catalog, "Test#stool"), AllOf(HasSubstr("a.sh3f"), HasSubstr("test/stool.obj")));
}

class InstalledFurniture : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFurnitureFolder)) GTEST_SKIP() << "sweethome3d-furniture is not installed";
  }
};

TEST_F(InstalledFurniture, EveryModelLoadsAtItsSizeOrSaysWhyNot) {
  const FurnitureCatalog catalog(kFurnitureFolder);
  std::size_t count = 0, refused = 0, flat = 0;
  for (const auto* entry : catalog.entries()) {
    ++count;
    const auto loaded = catalog.load(*entry, 64);
    if (const auto* refusal = std::get_if<FurnitureRefusal>(&loaded)) {
      ++refused;
      std::cout << "refused: " << refusal->reason << '\n';
      continue;
    }
    const auto box = bounds(std::get<Model>(loaded).mesh);
    EXPECT_NEAR(box.min().z(), 0, 1e-4) << entry->id;
    for (int axis = 0; axis < 3; ++axis) {
      if (box.sizes()[axis] < 1e-5F && ++flat > 0) continue;
      EXPECT_NEAR(box.sizes()[axis], entry->size_m[axis], 0.001) << entry->id;
    }
  }
  std::cout << count << " models, " << refused << " refused, " << flat << " flat extents\n";
  EXPECT_LT(static_cast<double>(refused), 0.06 * static_cast<double>(count));
}

// Whether the upper fifth of a model, as of a chair its back, lies behind its middle.
bool is_higher_behind(const Mesh& mesh) {
  const float height = bounds(mesh).max().z();
  Eigen::AlignedBox3f upper;
  for (const auto& p : mesh.positions) {
    if (p.z() > 0.8F * height) upper.extend(p);
  }
  return upper.center().y() > 0;
}

// An independent check of all the axes: people sit facing the front, with a back behind them.
TEST_F(InstalledFurniture, ChairsHaveTheirBacksBehind) {
  const FurnitureCatalog catalog(kFurnitureFolder);
  int chairs = 0, behind = 0;
  for (const auto* entry : catalog.entries()) {
    const bool is_seat = entry->name.ends_with("hair") || entry->name.ends_with("ofa");
    if (!is_seat) continue;
    const auto loaded = catalog.load(*entry, 16);
    const auto* const model = std::get_if<Model>(&loaded);
    if (model == nullptr) continue;
    ++chairs;
    if (is_higher_behind(model->mesh)) {
      ++behind;
    } else {
      std::cout << "not higher behind: " << entry->id << '\n';
    }
  }
  ASSERT_GT(chairs, 20);
  EXPECT_GT(behind, 0.9 * chairs);
}

}  // namespace
}  // namespace lapis::simulator
