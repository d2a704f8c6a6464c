#include "guided/seeds.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "formats/assimp/scene_transfer.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/npy/npz_motion.h"
#include "formats/obj/obj_writer.h"
#include "formats/pc2/pc2.h"
#include "golden/samples/samples.h"
#include "guided/mended_input.h"
#include "support/glb_builder.h"
#include "support/height_images.h"
#include "support/mesh_motions.h"
#include "support/small_images.h"

namespace krok::guided {

namespace {

namespace fs = std::filesystem;

class Seeds {
 public:
  explicit Seeds(fs::path folder) : folder_(std::move(folder)) {}

  void put(const std::string& target, const std::string& name, std::string_view bytes) const {
    fs::create_directories(folder_ / target);
    std::ofstream(folder_ / target / name, std::ios::binary) << bytes;
  }
  void put(const std::string& target, const std::string& name,
           const std::vector<std::byte>& bytes) const {
    put(target, name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  // For each target that takes scenes.
  void scene(const std::string& name, const std::vector<std::byte>& bytes) const {
    put("gltf", name, bytes);
    put("import_scene", name, bytes);
    if (const auto read = gltf::read(bytes)) put("assimp_result", name, assimp::pack(*read));
  }
  void written(const std::string& target, const std::string& name,
               const std::function<Status(OutputFile&)>& write) const {
    put(target, name, samples::bytes_of(write));
  }

 private:
  fs::path folder_;
};

MorphSet morphs() {
  const Model model = samples::model();
  MorphSet set;
  set.names = {"smile", "blink"};
  set.vertex_count = static_cast<int>(model.positions.size());
  for (int t = 0; t < 2; ++t) {
    for (const Vec3f& position : model.positions) {
      set.positions.push_back(position + Vec3f(0.1f * static_cast<float>(t + 1), 0, 0));
    }
  }
  return set;
}

constexpr const char* kSkeleton =
    "# made by hand\n:version 1.10\n:name t\n:units\n mass 1\n length 0.45\n angle deg\n"
    ":documentation\n none\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n"
    " orientation 0 0 0\n:bonedata\nbegin\n id 1\n name a\n direction 0 1 0\n length 2\n"
    " axis 0 0 20 XYZ\n dof rx ry rz\n limits (-160 20)\n (-70 70)\n (-inf inf)\nend\nbegin\n id "
    "2\n"
    " name b\n direction 1 0 0\n length 1\n axis 0 0 0 XYZ\n dof rx\nend\n:hierarchy\nbegin\n"
    " root a\n a b\nend\n";

constexpr const char* kCapture =
    "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 0.9 0\n\tCHANNELS 6 Xposition Yposition Zposition "
    "Zrotation "
    "Xrotation Yrotation\n\tJOINT LeftUpLeg\n\t{\n\t\tOFFSET 0.1 0 0\n\t\tCHANNELS 3 Zrotation "
    "Xrotation Yrotation\n\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -0.4 "
    "0\n\t\t}\n\t}\n}\nMOTION\nFrames: "
    "2\nFrame Time: 0.033333\n0 0.9 0 1 2 3 4 5 6\n0 0.9 0.1 1 2e1 3 -4 .5 6\n";

}  // namespace

void write_seeds(const std::string& folder) {
  const Seeds seeds(folder);
  for (const samples::Sample& sample : samples::all()) {
    const std::string target = fs::path(sample.file_name).extension().string().substr(1);
    const std::vector<std::byte> bytes = samples::bytes_of(sample.write);
    seeds.put(target, sample.file_name, bytes);
    seeds.put(target, sample.file_name + "_sections", taken_apart(bytes));
  }
  for (const samples::Sample& sample : samples::texts()) {
    seeds.written(fs::path(sample.file_name).extension().string().substr(1), sample.file_name,
                  sample.write);
  }
  const Clip clip = samples::clip();
  const Model model = samples::model();
  seeds.put("bvh", "hand.bvh", kCapture);
  seeds.written("bvh", "clip.bvh", [&](OutputFile& file) { return bvh::write(clip, {}, file); });
  seeds.put("acclaim_skeleton", "two.asf", kSkeleton);
  seeds.put(
      "acclaim_motion", "two.amc",
      "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\na 1 2 3\n2\nroot 0 1 0 9 0 "
      "0\na 4 5 6\n");
  for (const bool binary : {true, false}) {
    const std::string name = binary ? "rig.glb" : "rig.gltf";
    gltf::WriteOptions writing;
    writing.binary = binary;
    seeds.scene(name, samples::bytes_of([&](OutputFile& file) {
                  return gltf::write_rig(model, clip, writing, file);
                }));
  }
  seeds.scene("square.glb", test::square().glb());
  seeds.scene("baked.glb", test::baked_rig().glb());
  seeds.written("exr", "morphs.exr",
                [](OutputFile& file) { return morph_exr::write(morphs(), file); });
  seeds.put("exr", "heights.exr", test::exr_image(3, 2, {{"Y", {0, 1, 2, 3, 4, 5}}}));
  seeds.put("weights", "keys.csv", "frame,time,smile,\"blink, left\"\n0,0,0.5,1\n1,0.04,-0.5,2\n");
  seeds.put(
      "prints", "prints.csv",
      "side,x [m],z [m],heading [deg],height [m],time [s]\nleft,0.1,0,0,0,0\nright,-0.1,0.7,5,,"
      "0.5\n");
  seeds.put("image", "small.png", test::png());
  seeds.put("image", "small.jpg", test::jpeg());
  seeds.written("obj", "model.obj", [&](OutputFile& file) {
    return obj::write(model, MeshShape{model.positions, model.normals, {}}, {}, file);
  });
  seeds.written("pc2", "wobble.pc2", [&](OutputFile& file) {
    return pc2::write(model, test::wobble(model, 3), {}, file);
  });
  if (const auto arrays = npy::write_motion(frames_of(clip), {}); arrays) {
    seeds.put("arrays", "clip.npz",
              std::string(reinterpret_cast<const char*>(arrays->data()), arrays->size()));
  }
  // Each use and each edit by itself, of several motions: see run_operations for what bytes choose.
  for (int use = 0; use < 13; ++use) {
    for (int edit = 0; edit < 24; edit += use < 2 ? 1 : 6) {
      std::string bytes = {static_cast<char>(use), 1, static_cast<char>(edit)};
      for (int i = 0; i < 90; ++i) {
        bytes += static_cast<char>(i < 20 ? 140 - i : 60 + (i * (37 + edit) + use * 11) % 190);
      }
      // Backwards: a human or another skeleton, one of the usual rates, 40 frames.
      for (const int last : {40, 1, edit % 9, 1, use % 3 == 2 ? 1 : 0}) {
        bytes += static_cast<char>(last);
      }
      seeds.put("operations", std::to_string(use) + "_" + std::to_string(edit), bytes);
    }
  }
}

}  // namespace krok::guided
