#include "simulator/core/loaders/ply.hpp"

#include <gmock/gmock.h>

#include "unit/simulator/loaders/sample_scenes.hpp"

namespace lapis::simulator {
namespace {

using test::Bytes;
using test::PlyFormat;
using test::PlySource;
using ::testing::HasSubstr;

constexpr std::array<PlyFormat, 3> kFormats{PlyFormat::kAscii, PlyFormat::kLittleEndian, PlyFormat::kBigEndian};

PlySource colored_block() {
  PlySource source = test::floor_and_block();
  for (std::size_t i = 0; i < source.positions.size(); ++i)
    source.vertex_colors.push_back({static_cast<std::uint8_t>(i), 200, 255});
  source.labels = {"object_id"};
  source.label_values.resize(1);
  for (int i = 0; i < 12; ++i) {
    source.label_values[0].push_back(i * 1000 - 3);
    source.face_colors.push_back({static_cast<std::uint8_t>(i * 20), 1, 2});
  }
  return source;
}

std::string ply_error(const Bytes& bytes) {
  return test::error_of([&] { read_ply(bytes, "f.ply", {"object_id"}); });
}

std::string ply_error(const std::string& text) { return ply_error(test::to_bytes(text)); }

TEST(Ply, AllFormatsHoldTheSame) {
  const PlySource source = colored_block();
  for (const PlyFormat format : kFormats) {
    const PlyMesh mesh = read_ply(write_ply(source, format), "f.ply", source.labels);
    EXPECT_EQ(mesh.positions, source.positions);
    EXPECT_EQ(mesh.vertex_colors, source.vertex_colors);
    EXPECT_EQ(mesh.face_colors, source.face_colors);
    ASSERT_EQ(mesh.triangles.size(), source.polygons.size());
    for (std::size_t i = 0; i < source.polygons.size(); ++i) {
      EXPECT_TRUE(std::equal(mesh.triangles[i].begin(), mesh.triangles[i].end(), source.polygons[i].begin()));
      EXPECT_EQ(mesh.face_labels[0][i], source.label_values[0][i]);
    }
  }
}

TEST(Ply, PolygonsBecomeFansThatKeepTheirLabel) {
  PlySource source;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}};
  source.polygons = {{0, 1, 2, 3, 4}, {0, 1}, {2, 3, 4}};
  source.labels = {"object_id"};
  source.label_values = {{4, 5, 6}};
  const PlyMesh mesh = read_ply(write_ply(source, PlyFormat::kLittleEndian), "f.ply", source.labels);
  using Corners = std::array<std::uint32_t, 3>;
  EXPECT_THAT(mesh.triangles,
              testing::ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 3, 4}, Corners{2, 3, 4}));
  EXPECT_THAT(mesh.face_labels[0], testing::ElementsAre(4, 4, 4, 6));
}

TEST(Ply, SkipsWhatItDoesNotKnow) {
  const PlyMesh mesh = read_ply(test::to_bytes("ply\r\nformat ascii 1.0\r\nobj_info x\r\n"
                                               "element camera 1\nproperty list int float view\nproperty double f\n"
                                               "element vertex 3\nproperty float nx\nproperty double z\n"
                                               "property double y\nproperty double x\n"
                                               "element face 1\nproperty list uchar float uv\n"
                                               "property list uchar ushort vertex_index\nend_header\n"
                                               "3 7 8 9 0.5\n"
                                               "9 3 2 1\n9 6 5 4\n9 9 8 7\n"
                                               "2 0.1 0.2 3 2 1 0\n"),
                                "f.ply", {});
  EXPECT_THAT(mesh.positions,
              testing::ElementsAre(Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6), Eigen::Vector3f(7, 8, 9)));
  ASSERT_EQ(mesh.triangles.size(), 1U);
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{2, 1, 0}));
}

TEST(Ply, EveryTruncatedFileIsRefused) {
  for (const PlyFormat format : kFormats) {
    Bytes bytes = write_ply(colored_block(), format);
    if (format == PlyFormat::kAscii) {
      bytes.resize(bytes.size() - 2);  // a number that lost its last digits is still one
    }
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::string error = ply_error(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
      ASSERT_THAT(error, HasSubstr("f.ply: ")) << size << " of " << bytes.size() << " bytes";
      ASSERT_EQ(error.find('\n'), std::string::npos);
    }
  }
}

TEST(Ply, AbsurdCountsTakeNoMemory) {
  const std::string vertices = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string rest = "\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces =
      "element face 0\nproperty list int int vertex_indices\nproperty int object_id\nend_header\n";
  EXPECT_THAT(ply_error(vertices + "18446744073709551615" + rest + faces), HasSubstr("too short"));
  EXPECT_THAT(ply_error(vertices + "99999999999999999999" + rest + faces), HasSubstr("count"));
  EXPECT_THAT(ply_error(vertices + "-1" + rest + faces), HasSubstr("count"));
  const std::string list = vertices + "0" + rest +
                           "element face 1\nproperty list int int vertex_indices\nproperty int object_id\nend_header\n";
  EXPECT_THAT(ply_error(list + std::string("\xff\xff\xff\x7f\0\0\0\0", 8)), HasSubstr("longer than the file"));
  EXPECT_THAT(ply_error(list + std::string("\xff\xff\xff\xff\0\0\0\0", 8)), HasSubstr("longer than the file"));
}

TEST(Ply, RefusesIndicesOutOfRange) {
  for (const std::uint32_t index : {12U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    PlySource source = colored_block();
    source.polygons[3][1] = index;
    for (const PlyFormat format : kFormats)
      EXPECT_THAT(ply_error(write_ply(source, format)), HasSubstr("face 3 names a vertex")) << index;
  }
}

TEST(Ply, NamesWhatIsMissing) {
  const std::string body =
      "element face 0\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n";
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n" + body),
              HasSubstr("x, y and z"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\n" + body), HasSubstr("'vertex'"));
  EXPECT_THAT(ply_error("obj\n"), HasSubstr("no PLY file"));
  EXPECT_THAT(ply_error("ply\nformat xml 1.0\n"), HasSubstr("format 'xml'"));
  EXPECT_THAT(ply_error("ply\nelement vertex 1\nproperty int128 x\n"), HasSubstr("known type"));
  EXPECT_THAT(ply_error("ply\nproperty int x\n"), HasSubstr("before any element"));
  PlySource source = colored_block();
  source.labels = {"segment_id"};
  EXPECT_THAT(ply_error(write_ply(source, PlyFormat::kAscii)), HasSubstr("'object_id'"));
  EXPECT_THAT(ply_error(Bytes{}), HasSubstr("0 bytes"));
}

TEST(Ply, RefusesListsWhereANumberShouldBe) {
  const std::string vertex = "property float x\nproperty float y\nproperty float z\nproperty uchar red\n";
  const std::string face = "property list uchar int vertex_indices\nproperty int object_id\nproperty uchar red\n";
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 0\n" + vertex + "element face 0\n" + face + "end_header\n";
  EXPECT_EQ(ply_error(text), "");
  for (const char* property : {"float x", "float y", "float z", "uchar red", "int object_id"}) {
    std::string changed = text;
    const std::string whole = std::string("property ") + property;
    changed.replace(changed.rfind(whole), whole.size(), std::string("property list uchar ") + property);
    const std::string name = std::string(property).substr(std::string(property).find(' ') + 1);
    EXPECT_EQ(ply_error(changed), "f.ply: property '" + name + "' must be a number, not a list; export the file again");
  }
}

TEST(Ply, RefusesWordsThatAreNoNumbers) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 0\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n";
  EXPECT_THAT(ply_error(text + "1 two 3\n"), HasSubstr("'two' is no number"));
  EXPECT_EQ(ply_error(text + "1 nan 3\n"), "");  // what is not finite is left out later
}

}  // namespace
}  // namespace lapis::simulator
