#include "seeds.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/bags/bag_writer.hpp"
#include "common/files/zstd_codec.hpp"
#include "common/mapping/file/map_file.hpp"
#include "common/mapping/wire/frame_codec.hpp"
#include "fuzz_files.hpp"
#include "semantic_mapper/core/export.hpp"
#include "semantic_mapper/core/frame_journal.hpp"
#include "unit/mapping/random_votes.hpp"
#include "unit/planner/replay/sample_situation.hpp"
#include "unit/simulator/loaders/sample_scenes.hpp"
#include "unit/slam/sample_state.hpp"

namespace lapis::simulator::fuzz {
namespace {

using test::Files;
using test::to_bytes;
using Inputs = std::vector<Bytes>;

void add_labelled_ply(Inputs& inputs) {
  for (const auto format : {test::PlyFormat::kAscii, test::PlyFormat::kLittleEndian, test::PlyFormat::kBigEndian}) {
    const Files files = test::labelled_ply_files(format);
    inputs.push_back(join({files.at("scene_labelled.ply"), files.at("classes.csv"), files.at("instances.csv")}));
  }
  const Files files = test::labelled_ply_files();
  const std::string instances =
      "instance_id,name,model,class_id,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23\n"
      "1,a,ground,1,1,0,0,0,0,1,0,0,0,0,1,0\n7,b,,2,1,0,0,0,0,1,0,0,0,0,1,0\n";
  inputs.push_back(join({files.at("scene_labelled.ply"), files.at("classes.csv"), to_bytes(instances),
                         to_bytes("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n")}));
}

void add_gltf(Inputs& inputs) {
  const test::GltfBuilder builder = test::labelled_gltf();
  const Bytes semantics =
      to_bytes(R"({"instances":[{"id":2,"class":"wall","node":"wall"},{"id":3,"class":"table","material":"wood"}],)"
               R"("labels":["wall","table","chair"],"up":"z"})");
  inputs.push_back(join({builder.glb(), semantics}));
  inputs.push_back(join({builder.embedded(), semantics}));
  const Files files = builder.separate("a");
  inputs.push_back(join({files.at("a.gltf"), to_bytes("{}"), files.at("a.bin")}));
  inputs.push_back(join({test::hm3d_files().at("h.glb"), {}}));
  inputs.push_back(join({to_bytes("v 0 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3\n"), semantics}));
}

void add_scans(Seeds& seeds) {
  const Files house = test::matterport_files(), replica = test::replica_files(), hm3d = test::hm3d_files();
  seeds["house"] = {join({house.at("m.house"), house.at("m_semantic.ply")})};
  seeds["replica"] = {join({replica.at("info_semantic.json"), replica.at("mesh_semantic.ply")})};
  const Bytes &list = hm3d.at("h.semantic.txt"), &semantic = hm3d.at("h.semantic.glb"), &looks = hm3d.at("h.glb");
  seeds["hm3d"] = {join({list, test::hm3d_mapping(), semantic, looks}), join({list, {}, semantic, {}})};
}

const char* const kCatalog =
    "id=Test\nlicense=CC-BY\nid#1=Test#stool\nname#1=St\\u00fchl\ncategory#1=Kitchen\n"
    "model#1=/t/a.obj\nwidth#1=40\ndepth#1=30.5\nheight#1=50\nelevation#1=10\n"
    "dropOnTopElevation#1=90\nmovable#1=false\ncreator#1=A\nmodelRotation#1=1 0 0 0 0 1 0 -1 0\n";
const char* const kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\ng a\nusemtl red\nf 1/1 2/2 3/1 4/2\n"
    "o b\nusemtl glass\nf -4//1 -3//1 -2//1\nusemtl red\nf 1 3 4\n";
const char* const kMtl = "newmtl red\nKd 1 0.5 0\nd 1\nmap_Kd -o 1 1 a.png\nnewmtl glass\nTr 0.9\n";

void add_furniture(Seeds& seeds) {
  const Bytes picture = test::png(2, 3, {1, 2, 3, 100});
  seeds["catalog"] = {to_bytes(kCatalog)};
  seeds["obj"] = {join({to_bytes(kObj), to_bytes(kMtl), picture}), join({to_bytes(kObj), {}, {}})};
  const test::TemporaryFolder folder;
  for (const char* password : {"", "secret"}) {
    const auto file = folder.path() / "a.zip";
    test::write_zip(file, {{"a/", {}}, {"a/b.obj", to_bytes(kObj)}, {"c.properties", to_bytes(kCatalog)}}, password);
    seeds["zip"].push_back(test::read_file(file));
  }
}

void add_images(Inputs& inputs) {
  for (const auto& [ending, type] :
       {std::pair{".png", CV_8UC4}, {".png", CV_16UC1}, {".jpg", CV_8UC3}, {".bmp", CV_8UC3}}) {
    Bytes bytes;
    cv::imencode(ending, cv::Mat(5, 7, type, cv::Scalar(10, 200, 90, 60)), bytes);
    inputs.push_back(std::move(bytes));
  }
}

// Files of one text each; the fuzzer gives all of them to all readers.
void add_texts(Inputs& inputs) {
  const Files house = test::matterport_files(), hm3d = test::hm3d_files(), ply = test::labelled_ply_files();
  inputs = {house.at("m.house"),
            hm3d.at("h.semantic.txt"),
            test::hm3d_mapping(),
            ply.at("classes.csv"),
            ply.at("instances.csv"),
            to_bytes(kMtl),
            to_bytes(kCatalog),
            to_bytes("labels:\n  - {id: 3, name: wall, color: [1, 2, 3]}\n"),
            to_bytes("tour: [[1, 2], [3.5, -4]]\n"),
            to_bytes(R"({"instances":[{"id":2,"class":"wall","node":"a"},{"id":3,"class":"table","material":"b"}],)"
                     R"("labels":[{"id":9,"name":"wall"},{"id":4,"name":"table"}],"up":"y"})")};
}

void add_poses(Seeds& seeds) {
  seeds["pose_graph"] = {
      to_bytes("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0.6 0.8\nFIX 0\n"
               "EDGE_SE3:QUAT 0 1 1.1 0 0 0 0 0 1 9 0 0 0 0 0 9 0 0 0 0 9 0 0 0 4 0 0 4 0 4\n"
               "EDGE_SE3:QUAT 1 7 0 1 0 0.1 0 0 1 9 0 0 0 0 0 9 0 0 0 0 9 0 0 0 4 0 0 4 0 4\n"
               "EDGE_SE3:QUAT 7 0 2 0 0 0 0.7 0 0.7 9 1 0 0 0 0 9 0 0 0 0 9 0 0 0 4 0 0 4 0 4\n"),
      to_bytes(
          "# plane\nVERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 1.5 4 0 0 4 0 9\nEDGE_SE2 1 2 1 0 1.5 4 0 0 4 0 9\n"
          "EDGE_SE2 2 3 1 0 1.6 4 0 0 4 0 9\nEDGE_SE2 3 0 1.4 0 -4.7 4 0 1 4 0 9\nEDGE_SE2 0 3 -9 2 1 4 0 1 4 0 9\n"),
      to_bytes("VERTEX2 0 0 0 0\nEDGE2 0 5 1 2 0.5 1 0 1 1 0 0\nEQUIV 0 5\n"),
      to_bytes("VERTEX3 1 0 0 0 0 0 0\nEDGE3 1 2 1 0 0 0.1 0.2 3 9 0 0 0 0 0 9 0 0 0 0 9 0 0 0 4 0 0 4 0 4\n")};
  seeds["trajectory"] = {to_bytes("# t x y z q\n0.5 1 2 3 0 0 0 1\n1305031102.175304 1.5,2e-3,-3 0 0 0.6 0.8\n")};
}

void add_scene_files(Inputs& inputs) {
  const std::string rooms =
      "rooms:\n  - {id: a, rect: [0, 0, 2, 1.5], wall: {texture: brick, color: [200, 90, 9]}}\n"
      "  - {id: b, type: hall, polygon: [[2.12, 0], [2.12, 1.5], [4, 1.5], [4, 0]], floor: tiles, height: 2.4}\n";
  inputs = {
      to_bytes(rooms + "openings:\n  - {door: [2.06, 0.7]}\n  - {window: [1, 0], width: 0.8, bottom: 1}\n"
                       "furniture:\n  - {id: t, class: table, size: [0.5, 0.4, 0.7], room: a, wall: north, x: 1}\n"
                       "  - {class: chair, on: t, offset: [0, 0.1], elevation: -0.1, movable: true, variant: 3}\n"),
      to_bytes(rooms + "furniture:\n  - {class: chair, at: [1, 0.6], yaw_deg: 30, parts: {leg: table}, "
                       "row: {count: 2, step: [0.5, 0]}}\n"
                       "lamps:\n  - {at: [1, 1], height: 2, intensity: 0.5}\nstress: true\n"),
      to_bytes(rooms + "pictures:\n  - {room: b, wall: 2, along: -0.6, size: [0.4, 0.3], motif: 4}\n"
                       "starts:\n  - {at: [1, 1], yaw_deg: 90}\ntour: [[1, 1], [3, 1]]\nheight: 3\n"
                       "wall_thickness: 0.2\nname: x\nlabels: ../labels/mpcat40.yaml\n"),
      to_bytes(
          std::string("network: a.onnx\nlabels: ../labels/mpcat40.yaml\n"
                      "input: {width: 32, height: 24, layout: NHWC, channels: bgr, scale: 1, mean: [1, 2, 3], "
                      "std: [4, 5, 6]}\noutput: {name: out, values: probabilities}\nclasses: {0: wall, 3: table}\n"))};
}

void add_maps(Seeds& seeds) {
  constexpr std::size_t kMapHeader = 24, kMaxContent = std::size_t{1} << 24;
  const mapping::MapFile map{mapping::test::random_map(1), {}, mapping::LabelList::from_names({{1, "wall"}}), {}};
  const mapping::BeliefReader reader(map.sensor_model);
  const Bytes file = mapping::encode_map(map);
  seeds["map"] = {file, files::zstd_decompress(std::span(file).subspan(kMapHeader), kMaxContent).value()};
  seeds["octree"] = {semantic_mapper::encode_octree(map.map, reader, map.labels).file,
                     semantic_mapper::encode_binary_octree(map.map, reader)};
}

// Small chunks, so that a file has several.
void add_bags(Inputs& inputs) {
  for (const auto& [storage, level] :
       {std::pair{bags::Storage::kMcap, 1}, {bags::Storage::kMcap, 0}, {bags::Storage::kSqlite3, 0}}) {
    const test::TemporaryFolder folder;
    bags::BagWriter writer(folder.path() / "bag", {.storage = storage,
                                                   .mcap = {.compression_level = level, .chunk_bytes = 64},
                                                   .split_bytes = 0,
                                                   .split_s = 0.0});
    writer.add_channel({.topic = "/a",
                        .type = "std_msgs/msg/String",
                        .encoding = "cdr",
                        .schema_encoding = "ros2msg",
                        .schema = "string data\n",
                        .type_hash = "",
                        .offered_qos = ""});
    for (int i = 0; i < 4; ++i) writer.write({0, 0, 1000 - i, 1000, Bytes(20, static_cast<std::uint8_t>(i))});
    writer.close();
    inputs.push_back(test::read_file(folder.path() / "bag" / writer.files().front().name));
    inputs.push_back(test::read_file(folder.path() / "bag" / "metadata.yaml"));
  }
}

void add_frames(Inputs& inputs) {
  const geometry::PinholeCamera camera{6, 4, 5, 5, 2.5, 1.5};
  const geometry::DepthImage depth(camera.width, camera.height, 1.5f);
  const geometry::LabelImage labels(camera.width, camera.height, 3);
  const geometry::ConfidenceImage confidence(camera.width, camera.height, 200);
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "frames.lapis";
  std::string error;
  for (const std::uint64_t frames : {1U, 3U}) {
    semantic_mapper::FrameJournal journal(file.string(), 1);
    for (std::uint64_t i = 0; i < frames; ++i) {
      const auto samples = mapping::CompactFrame::make(camera, depth, i % 2 == 0 ? &labels : nullptr, {1, 40}, error,
                                                       i % 3 == 0 ? &confidence : nullptr);
      semantic_mapper::FrameRecord record;
      record.keyframe_id = i;
      record.drift = {0.1, 0.01};
      record.is_held = i == 1;
      if (const auto problem = journal.append(record, mapping::pack(samples.value())))
        throw std::runtime_error(*problem);
    }
    inputs.push_back(test::read_file(file));
  }
}

}  // namespace

Seeds seeds() {
  Seeds seeds;
  add_labelled_ply(seeds["ply"]);
  add_gltf(seeds["gltf"]);
  add_scans(seeds);
  add_furniture(seeds);
  add_images(seeds["image"]);
  add_texts(seeds["text"]);
  add_scene_files(seeds["scene"]);
  for (const unsigned keyframes : {1U, 3U})
    seeds["slam"].push_back(slam::encode_slam_file(slam::test::sample_file(keyframes, keyframes)));
  seeds["situation"] = {planner::encode_situation(planner::test::sample_situation())};
  add_poses(seeds);
  add_maps(seeds);
  add_frames(seeds["frames"]);
  add_bags(seeds["bag"]);
  return seeds;
}

}  // namespace lapis::simulator::fuzz
