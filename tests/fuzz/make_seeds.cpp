// Writes the first inputs of the fuzzers: lapis_fuzz_seeds FOLDER makes FOLDER/NAME/0, FOLDER/NAME/1, ...

#include <iostream>

#include "fuzz_files.hpp"
#include "unit/simulator/loaders/sample_scenes.hpp"

namespace {

namespace fs = std::filesystem;
namespace test = lapis::simulator::test;
using lapis::simulator::fuzz::join;
using test::Bytes;
using test::Files;
using test::to_bytes;

class Corpus {
 public:
  explicit Corpus(fs::path folder) : folder_(std::move(folder)) {}
  void add(const Bytes& input) { test::write_file(folder_ / std::to_string(count_++), input); }

 private:
  fs::path folder_;
  int count_ = 0;
};

void add_labelled_ply(Corpus corpus) {
  for (const auto format : {test::PlyFormat::kAscii, test::PlyFormat::kLittleEndian, test::PlyFormat::kBigEndian}) {
    const Files files = test::labelled_ply_files(format);
    corpus.add(join({files.at("scene_labelled.ply"), files.at("classes.csv"), files.at("instances.csv")}));
  }
  const Files files = test::labelled_ply_files();
  const std::string instances =
      "instance_id,name,model,class_id,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23\n"
      "1,a,ground,1,1,0,0,0,0,1,0,0,0,0,1,0\n7,b,,2,1,0,0,0,0,1,0,0,0,0,1,0\n";
  corpus.add(join({files.at("scene_labelled.ply"), files.at("classes.csv"), to_bytes(instances),
                   to_bytes("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n")}));
}

void add_gltf(Corpus corpus) {
  const test::GltfBuilder builder = test::labelled_gltf();
  const Bytes semantics =
      to_bytes(R"({"instances":[{"id":2,"class":"wall","node":"wall"},{"id":3,"class":"table","material":"wood"}],)"
               R"("labels":["wall","table","chair"],"up":"z"})");
  corpus.add(join({builder.glb(), semantics}));
  corpus.add(join({builder.embedded(), semantics}));
  const Files files = builder.separate("a");
  corpus.add(join({files.at("a.gltf"), to_bytes("{}"), files.at("a.bin")}));
  corpus.add(join({test::hm3d_files().at("h.glb"), {}}));
  corpus.add(join({to_bytes("v 0 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3\n"), semantics}));
}

void add_scans(const fs::path& folder) {
  const Files house = test::matterport_files(), replica = test::replica_files(), hm3d = test::hm3d_files();
  Corpus(folder / "house").add(join({house.at("m.house"), house.at("m_semantic.ply")}));
  Corpus(folder / "replica").add(join({replica.at("info_semantic.json"), replica.at("mesh_semantic.ply")}));
  Corpus corpus(folder / "hm3d");
  const Bytes &list = hm3d.at("h.semantic.txt"), &semantic = hm3d.at("h.semantic.glb"), &looks = hm3d.at("h.glb");
  corpus.add(join({list, test::hm3d_mapping(), semantic, looks}));
  corpus.add(join({list, {}, semantic, {}}));
}

void add_furniture(const fs::path& folder) {
  Corpus(folder / "catalog")
      .add(to_bytes("id=Test\nlicense=CC-BY\nid#1=Test#stool\nname#1=St\\u00fchl\ncategory#1=Kitchen\n"
                    "model#1=/t/a.obj\nwidth#1=40\ndepth#1=30.5\nheight#1=50\nelevation#1=10\n"
                    "dropOnTopElevation#1=90\nmovable#1=false\ncreator#1=A\nmodelRotation#1=1 0 0 0 0 1 0 -1 0\n"));
  Corpus obj(folder / "obj");
  const std::string quads =
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\ng a\nusemtl red\nf 1/1 2/2 3/1 4/2\n"
      "o b\nusemtl glass\nf -4//1 -3//1 -2//1\nusemtl red\nf 1 3 4\n";
  Bytes input = to_bytes(quads);
  input.push_back(0);
  const Bytes materials = to_bytes("newmtl red\nKd 1 0.5 0\nd 1\nmap_Kd -o 1 1 a.png\nnewmtl glass\nTr 0.9\n");
  input.insert(input.end(), materials.begin(), materials.end());
  obj.add(input);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: lapis_fuzz_seeds FOLDER\n";
    return 2;
  }
  const fs::path folder = argv[1];
  add_labelled_ply(Corpus(folder / "ply"));
  add_gltf(Corpus(folder / "gltf"));
  add_scans(folder);
  add_furniture(folder);
  return 0;
}
