#include "unit/simulator/loaders/sample_scenes.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace lapis::simulator::test {
namespace {

using nlohmann::json;

// Numbers one after the other as a PLY file of the format has them.
class PlyBody {
 public:
  explicit PlyBody(PlyFormat format) : format_(format) {}

  template <class Number>
  void add(Number value) {
    if (format_ == PlyFormat::kAscii) {
      const std::string text = std::to_string(value) + " ";
      bytes.insert(bytes.end(), text.begin(), text.end());
      return;
    }
    std::array<std::uint8_t, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &value, raw.size());
    if (format_ == PlyFormat::kBigEndian) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  void add(const geometry::Rgb8& color) {
    for (const std::uint8_t channel : {color.r, color.g, color.b}) add(channel);
  }
  void end_row() {
    if (format_ == PlyFormat::kAscii) bytes.back() = '\n';
  }

  Bytes bytes;

 private:
  PlyFormat format_;
};

std::string ply_header(const PlySource& source, PlyFormat format) {
  const char* name = format == PlyFormat::kAscii          ? "ascii"
                     : format == PlyFormat::kLittleEndian ? "binary_little_endian"
                                                          : "binary_big_endian";
  const std::string color = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string text = "ply\nformat " + std::string(name) + " 1.0\ncomment made by a test\n";
  text += "element vertex " + std::to_string(source.positions.size()) + "\n";
  text += "property float x\nproperty float y\nproperty float z\n";
  if (!source.vertex_colors.empty()) text += color;
  text += "element face " + std::to_string(source.polygons.size()) + "\nproperty list uchar int vertex_indices\n";
  for (const auto& label : source.labels) text += "property int " + label + "\n";
  if (!source.face_colors.empty()) text += color;
  return text + "end_header\n";
}

template <class Number>
Bytes bytes_of(const std::vector<Number>& values) {
  Bytes bytes(values.size() * sizeof(Number));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

void append_u32(Bytes& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift & 0xFF));
}

void append_chunk(Bytes& glb, const char* type, Bytes content, std::uint8_t padding) {
  while (content.size() % 4 != 0) content.push_back(padding);
  append_u32(glb, content.size());
  for (int i = 0; i < 4; ++i) glb.push_back(static_cast<std::uint8_t>(type[i]));
  glb.insert(glb.end(), content.begin(), content.end());
}

std::string base64(const Bytes& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) { return i + k < bytes.size() ? unsigned{bytes[i + k]} : 0U; };
    const unsigned group = at(0) << 16 | at(1) << 8 | at(2);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[group >> (18 - 6 * static_cast<unsigned>(k)) & 63] : '=';
  }
  return text;
}

// The left half of one colour, the right half of another one.
Bytes halves_png(const cv::Vec3b& left, const cv::Vec3b& right) {
  cv::Mat image(8, 8, CV_8UC3);
  image.colRange(0, 4).setTo(left);
  image.colRange(4, 8).setTo(right);
  Bytes bytes;
  cv::imencode(".png", image, bytes);
  return bytes;
}

}  // namespace

Bytes write_ply(const PlySource& source, PlyFormat format) {
  PlyBody body(format);
  for (std::size_t i = 0; i < source.positions.size(); ++i) {
    for (int k = 0; k < 3; ++k) body.add(source.positions[i][k]);
    if (!source.vertex_colors.empty()) body.add(source.vertex_colors[i]);
    body.end_row();
  }
  for (std::size_t i = 0; i < source.polygons.size(); ++i) {
    body.add(static_cast<std::uint8_t>(source.polygons[i].size()));
    for (const std::uint32_t v : source.polygons[i]) body.add(static_cast<std::int32_t>(v));
    for (const auto& values : source.label_values) body.add(values[i]);
    if (!source.face_colors.empty()) body.add(source.face_colors[i]);
    body.end_row();
  }
  Bytes bytes = to_bytes(ply_header(source, format));
  bytes.insert(bytes.end(), body.bytes.begin(), body.bytes.end());
  return bytes;
}

PlySource floor_and_block() {
  PlySource source;
  source.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  source.polygons = {{0, 1, 2}, {0, 2, 3}};
  for (const float z : {0.0F, 0.8F}) {
    for (const auto& [x, y] : {std::pair(0.5F, 0.5F), {0.9F, 0.5F}, {0.9F, 0.9F}, {0.5F, 0.9F}})
      source.positions.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t a = 4 + i, b = 4 + (i + 1) % 4;
    source.polygons.push_back({a, b, b + 4});
    source.polygons.push_back({a, b + 4, a + 4});
  }
  source.polygons.push_back({8, 9, 10});
  source.polygons.push_back({8, 10, 11});
  return source;
}

Files labelled_ply_files(PlyFormat format) {
  PlySource source = floor_and_block();
  source.labels = {"class_id", "instance_id"};
  source.label_values = {std::vector<std::int32_t>(12, 2), std::vector<std::int32_t>(12, 7)};
  for (std::size_t i = 0; i < 2; ++i) source.label_values[0][i] = source.label_values[1][i] = 1;
  return {{"scene_labelled.ply", write_ply(source, format)},
          {"classes.csv", to_bytes("class_id,class\n1,floor\n2,chair\n")},
          {"instances.csv", to_bytes("instance_id,name,class_id,class\n1,ground,1,floor\n7,\"block, red\",2,chair\n")}};
}

Files matterport_files() {
  PlySource source = floor_and_block();
  source.vertex_colors.assign(source.positions.size(), {10, 20, 30});
  source.labels = {"object_id"};
  source.label_values = {{0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 2, -1}};
  const std::string house =
      "ASCII 1.1\n"
      "H m m 0 0 0 0 0 3 2 1 0 1  0 0 0 0 0  0 0 0 2 2 2  0 0 0 0 0\n"
      "L 0 1 -  1 1 1  0 0 0 2 2 2  0 0 0 0 0\n"
      "R 0 0 0 0 b  1 1 1  0 0 0 2 2 2  2.5 0 0 0 0\n"
      "C 0 5 floor#boards 2 floor 0 0 0 0 0\n"
      "C 1 9 office#chair 3 chair 0 0 0 0 0\n"
      "O 0 0 0  1 1 0  1 0 0  0 1 0  1 1 0.1  0 0 0 0 0 0 0 0\n"
      "O 1 0 1  0.7 0.7 0.4  1 0 0  0 1 0  0.2 0.2 0.4  0 0 0 0 0 0 0 0\n"
      "O 2 0 -1  0 0 0  1 0 0  0 1 0  0 0 0  0 0 0 0 0 0 0 0\n"
      "E 0 0 0 1  0 0 0  0 0 0 1 1 1  0 0 0 0 0\n";
  return {{"m.house", to_bytes(house)}, {"m_semantic.ply", write_ply(source, PlyFormat::kLittleEndian)}};
}

Files replica_files() {
  PlySource source;
  source.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 2, 1}, {2, 2, 1}};
  source.vertex_colors.assign(6, {200, 100, 50});
  source.polygons = {{0, 1, 2, 3}, {3, 2, 5, 4}};
  source.labels = {"object_id"};
  source.label_values = {{0, 5}};
  const json info{{"classes", {{{"id", 40}, {"name", "floor"}}, {{"id", 93}, {"name", "wall"}}}},
                  {"objects", {{{"id", 0}, {"class_id", 40}}, {{"id", 5}, {"class_id", 93}}}}};
  return {{"mesh_semantic.ply", write_ply(source, PlyFormat::kLittleEndian)},
          {"info_semantic.json", to_bytes(info.dump())}};
}

Files hm3d_files() {
  const auto build = [](const Bytes& image) {
    GltfBuilder builder;
    const std::size_t material = builder.add_textured_material(builder.add_image(image));
    // The first triangle lies below the left half of the texture, the second one below the right half.
    const std::size_t positions = builder.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 1, 2, 0}, 3);
    const std::size_t coordinates =
        builder.add_floats({0.05F, 0.1F, 0.4F, 0.1F, 0.1F, 0.9F, 0.6F, 0.1F, 0.95F, 0.1F, 0.6F, 0.9F}, 2);
    const std::size_t mesh = builder.add_mesh(
        {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", coordinates}}}, {"material", material}});
    builder.add_node({{"name", "chunk"}, {"mesh", mesh}});
    return builder.glb();
  };
  const std::string text =
      "HM3D Semantic Annotations\n"
      "1,FF0010,\"floor\",0\n"
      "2,00FF20,\"armchair, red\",0\n"
      "3,0000FF,\"lamp\",1\n";
  return {{"h.semantic.glb", build(halves_png({0x10, 0, 0xFF}, {0x20, 0xFF, 0}))},  // OpenCV has blue first
          {"h.semantic.txt", to_bytes(text)},
          {"h.glb", build(png(4, 4, {90, 80, 70, 255}))}};
}

Bytes hm3d_mapping() {
  return to_bytes("raw_category\tcategory\tmpcat40\nfloor\tfloor\tfloor\narmchair, red\tarmchair\tchair\n");
}

GltfBuilder::GltfBuilder()
    : root{{"asset", {{"version", "2.0"}}},
           {"scene", 0},
           {"scenes", {{{"nodes", json::array()}}}},
           {"nodes", json::array()},
           {"meshes", json::array()},
           {"accessors", json::array()},
           {"bufferViews", json::array()}} {}

std::size_t GltfBuilder::add_view(const Bytes& bytes, std::size_t stride) {
  while (binary_.size() % 4 != 0) binary_.push_back(0);
  json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  root["bufferViews"].push_back(view);
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  return root["bufferViews"].size() - 1;
}

std::size_t GltfBuilder::add_accessor(const Bytes& bytes, std::size_t component_type, const std::string& type,
                                      std::size_t count, std::size_t stride, bool is_normalized) {
  json accessor{
      {"bufferView", add_view(bytes, stride)}, {"componentType", component_type}, {"type", type}, {"count", count}};
  if (is_normalized) accessor["normalized"] = true;
  root["accessors"].push_back(accessor);
  return root["accessors"].size() - 1;
}

std::size_t GltfBuilder::add_floats(const std::vector<float>& values, std::size_t width) {
  return add_accessor(bytes_of(values), 5126, "VEC" + std::to_string(width), values.size() / width);
}

std::size_t GltfBuilder::add_indices(const std::vector<std::uint16_t>& values) {
  return add_accessor(bytes_of(values), 5123, "SCALAR", values.size());
}

std::size_t GltfBuilder::add_image(const Bytes& bytes) {
  root["images"].push_back({{"bufferView", add_view(bytes, 0)}, {"mimeType", "image/png"}});
  return root["images"].size() - 1;
}

std::size_t GltfBuilder::add_textured_material(std::size_t image, const std::string& name) {
  root["textures"].push_back({{"source", image}});
  const json texture{{"index", root["textures"].size() - 1}};
  root["materials"].push_back({{"name", name}, {"pbrMetallicRoughness", {{"baseColorTexture", texture}}}});
  return root["materials"].size() - 1;
}

std::size_t GltfBuilder::add_mesh(const json& primitive) {
  root["meshes"].push_back({{"primitives", json::array({primitive})}});
  return root["meshes"].size() - 1;
}

std::size_t GltfBuilder::add_node(const json& node) {
  root["nodes"].push_back(node);
  root["scenes"][0]["nodes"].push_back(root["nodes"].size() - 1);
  return root["nodes"].size() - 1;
}

Bytes GltfBuilder::glb() const {
  json with_buffer = root;
  with_buffer["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  Bytes chunks;
  append_chunk(chunks, "JSON", to_bytes(with_buffer.dump()), ' ');
  append_chunk(chunks, "BIN", binary_, 0);
  Bytes result = to_bytes("glTF");
  append_u32(result, 2);
  append_u32(result, chunks.size() + 12);
  result.insert(result.end(), chunks.begin(), chunks.end());
  return result;
}

Files GltfBuilder::separate(const std::string& name) const {
  json with_buffer = root;
  with_buffer["buffers"] = json::array({{{"byteLength", binary_.size()}, {"uri", name + ".bin"}}});
  return {{name + ".gltf", to_bytes(with_buffer.dump())}, {name + ".bin", binary_}};
}

Bytes GltfBuilder::embedded() const {
  json with_buffer = root;
  const std::string uri = "data:application/octet-stream;base64," + base64(binary_);
  with_buffer["buffers"] = json::array({{{"byteLength", binary_.size()}, {"uri", uri}}});
  return to_bytes(with_buffer.dump());
}

std::size_t add_triangle_mesh(GltfBuilder& builder, std::optional<std::size_t> material) {
  json primitive{{"attributes", {{"POSITION", builder.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}};
  if (material) primitive["material"] = *material;
  return builder.add_mesh(primitive);
}

GltfBuilder labelled_gltf() {
  GltfBuilder builder;
  builder.root["materials"] = json::array(
      {{{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.5, 0.0, 1.0}}}}}, {{"name", "wood"}}});
  const std::size_t painted = add_triangle_mesh(builder, 0), wooden = add_triangle_mesh(builder, 1);
  builder.add_node({{"name", "house"}, {"children", {1, 2}}});
  builder.root["nodes"].push_back({{"name", "chair"}, {"mesh", wooden}, {"extras", {{"class", "chair"}}}});
  builder.root["nodes"].push_back({{"name", "wall"}, {"mesh", painted}, {"translation", {0, 0, 3}}});
  return builder;
}

}  // namespace lapis::simulator::test
