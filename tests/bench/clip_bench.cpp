// A whole clip into a file, 10,000 vertices x 600 frames, skinned as it is written: as GLB with
// morph targets and as a PC2 point cache, on one thread and on two. Beside it the same bytes
// written alone, from a buffer that does not change, by the same OutputFile into the same folder.
//
//   clip [FOLDER]    the folder for the files; the current one by default
//
// Each is measured with the wait for the disk that every file of the tools ends with, and without.
// Rounds of all take turns and the fastest of each counts; what is printed are ratios, which
// compare across machines, times of this one, and a hash of the file. Two threads need two idle
// cores. The processor's time counts neither waiting nor what else the machine does.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/hash.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/pc2/pc2.h"
#include "skin/skin.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"

namespace {

using namespace krok;

constexpr int kFrames = 600;
constexpr int kRounds = 15;

struct Scene {
  Clip clip = test::swinging_clip(test::human_skeleton(), kFrames, 60);
  Model model;
  SkinBinding binding;

  // Rings are added until there are about 10,000 vertices.
  Scene() : model(mesh(clip.skeleton)), binding(model, SkinMethod::linear) {}

  static Model mesh(const Skeleton& skeleton) {
    int rings = 2;
    while (test::tube_model(skeleton, 4, rings, 16).vertex_count() < 10'000) ++rings;
    return test::tube_model(skeleton, 4, rings, 16);
  }

  MeshMotion motion() {
    MeshMotion motion;
    motion.frames = kFrames;
    motion.rate = clip.rate;
    motion.source = [this]() -> ShapeSource {
      return [this, pose = std::make_shared<SkinPose>(binding),
              joints = std::vector<Transform>(clip.skeleton.names.size())](
                 int frame, const ShapeOutput& to) mutable {
        clip.get_pose(frame, joints);
        pose->set(joints);
        SkinSurface in = skin_surface(model);
        in.tangents = {};
        if (to.normals.empty()) in.normals = {};
        skin(binding, *pose, in, {to.positions, to.normals, {}});
      };
    };
    return motion;
  }
};

using Write = std::function<Status(OutputFile&)>;

void stop(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  std::exit(1);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct Cost {
  double wall = 0, processor = 0;  // seconds
};

// From nothing to a file in its place.
Cost cost_to_write(const std::string& path, bool wait, const Write& write) {
  std::filesystem::remove(path);
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  OutputFile::Options options;
  options.stored_later = !wait;
  auto file = OutputFile::create(path, options);
  if (!file) stop(file.error());
  if (const Status status = write(*file); !status) stop(status.error());
  if (const Status status = file->commit(); !status) stop(status.error());
  return {seconds_since(begin), static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC};
}

Write plain(std::uint64_t bytes) {
  return [bytes, block = std::vector<std::byte>(std::size_t{1} << 18, std::byte{1})](
             OutputFile& file) -> Status {
    for (std::uint64_t left = bytes; left > 0;) {
      const auto count = std::min<std::uint64_t>(left, block.size());
      if (Status status = file.write(std::span(block).first(count)); !status) return status;
      left -= count;
    }
    return {};
  };
}

void compare(const char* format, const std::string& path, bool wait, const Write& one,
             const Write& two) {
  cost_to_write(path, false, one);
  const auto bytes = std::filesystem::file_size(path);
  const auto file = InputFile::open(path);
  const std::string hash = file ? hex(file->checksum()) : "";
  const std::vector<Write> writes = {plain(bytes), one, two};
  std::vector<Cost> fastest(writes.size(), Cost{1e9, 1e9});
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < writes.size(); ++i) {
      const Cost cost = cost_to_write(path, wait, writes[i]);
      fastest[i].wall = std::min(fastest[i].wall, cost.wall);
      fastest[i].processor = std::min(fastest[i].processor, cost.processor);
    }
  }
  const auto& [alone, one_thread, two_threads] = std::tie(fastest[0], fastest[1], fastest[2]);
  std::printf("%s, %.0f MB, %s\n", format, static_cast<double>(bytes) * 1e-6,
              wait ? "on the disk" : "without waiting for the disk");
  std::printf("  whole / bytes alone: one thread %.2f, two threads %.2f\n",
              one_thread.wall / alone.wall, two_threads.wall / alone.wall);
  std::printf("  seconds: bytes alone %.3f, one thread %.3f, two threads %.3f\n", alone.wall,
              one_thread.wall, two_threads.wall);
  std::printf("  processor's seconds: bytes alone %.3f, one thread %.3f; hash %s\n",
              alone.processor, one_thread.processor, hash.c_str());
  std::filesystem::remove(path);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : ".";
  Scene scene;
  const MeshMotion motion = scene.motion();
  std::printf("%d vertices, %d frames\n", scene.model.vertex_count(), motion.frames);
  const ShapeSource source = motion.source();
  std::vector<Vec3f> positions(scene.model.positions.size()), normals(positions.size());
  const auto begin = std::chrono::steady_clock::now();
  for (int f = 0; f < kFrames; ++f) source(f, {positions, normals, {}});
  std::printf("skinning alone: %.3f seconds\n", seconds_since(begin));
  const auto glb = [&](int jobs) {
    return [&, jobs](OutputFile& file) {
      return gltf::write_baked(scene.model, motion, {}, file, nullptr, jobs);
    };
  };
  const auto pc2 = [&](int jobs) {
    return [&, jobs](OutputFile& file) {
      return pc2::write(scene.model, motion, {}, file, nullptr, jobs);
    };
  };
  for (const bool wait : {true, false}) {
    compare("GLB", folder + "/clip_bench.glb", wait, glb(1), glb(2));
    compare("PC2", folder + "/clip_bench.pc2", wait, pc2(1), pc2(2));
  }
  return 0;
}
