// Comparing meshes: two GLB files of 100,000 vertices read and compared, beside reading them alone;
// and a rig's clip against the same clip baked. One thread. Rounds take turns and the fastest of
// each counts; what is printed are ratios, which compare across machines, times of this one, and a
// hash of the results.

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "compare/scene_difference.h"
#include "core/file.h"
#include "core/hash.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_writer.h"
#include "math/quaternion.h"
#include "nodes/scene_of.h"

namespace {

using namespace krok;

constexpr int kJoints = 20;
constexpr int kRounds = 15;

// A bumpy tube along Y around a chain of joints, two influences a vertex.
Model make_tube(int around, int along) {
  Model model;
  for (int j = 0; j < kJoints; ++j) {
    model.skeleton.add("joint" + std::to_string(j), j - 1,
                       {Vec3(0, 2.0 * j / kJoints, 0), Quat::Identity()});
  }
  model.influences_per_vertex = 2;
  for (int y = 0; y < along; ++y) {
    for (int x = 0; x < around; ++x) {
      const double angle = 2 * kPi * x / around;
      const double radius = 0.2 + 0.02 * std::sin(9 * angle + 0.3 * y);
      const double height = 1.9 * y / along;
      const Vec3 out(std::cos(angle), 0, std::sin(angle));
      model.positions.push_back((radius * out + Vec3(0, height, 0)).cast<float>());
      model.normals.push_back(out.cast<float>());
      const double joint = height / 2.0 * kJoints;
      const auto below = static_cast<std::uint16_t>(joint);
      const auto share = static_cast<float>(0.95 - 0.4 * (joint - below));
      const auto above = static_cast<std::uint16_t>(std::min(below + 1, kJoints - 1));
      model.influence_joints.insert(model.influence_joints.end(), {below, above});
      model.influence_weights.insert(model.influence_weights.end(), {share, 1 - share});
      if (y + 1 == along) continue;
      const auto at = [&](int i, int k) {
        return static_cast<std::uint32_t>((y + k) * around + (x + i) % around);
      };
      model.triangles.push_back({at(0, 0), at(0, 1), at(1, 0)});
      model.triangles.push_back({at(1, 0), at(0, 1), at(1, 1)});
    }
  }
  model.parts = {{"tube", "", 0, static_cast<std::uint32_t>(model.triangles.size())}};
  return model;
}

Clip make_clip(const Model& model, int frames) {
  Clip clip;
  clip.skeleton = model.skeleton;
  clip.resize(frames);
  for (int f = 0; f < frames; ++f) {
    std::vector<Transform> pose = model.skeleton.reference;
    for (std::size_t j = 1; j < pose.size(); ++j) {
      const Quat bend = from_rotation_vector(Vec3(0.05 * std::sin(0.1 * f), 0, 0.02));
      pose[j].orientation = pose[j - 1].orientation * bend;
      pose[j].position = pose[j - 1].position + pose[j - 1].orientation * Vec3(0, 0.1, 0);
    }
    clip.set_pose(f, pose);
  }
  return clip;
}

// Linear blend skinning as it stands in a textbook.
MeshMotion skinned(const Model& model, const Clip& clip) {
  MeshMotion motion;
  motion.frames = clip.frame_count();
  motion.rate = clip.rate;
  motion.source = copies_of([&model, &clip](int frame, const ShapeOutput& to) {
    std::vector<Transform> pose(model.skeleton.reference.size());
    clip.get_pose(frame, pose);
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      Vec3 position = Vec3::Zero();
      Vec3 normal = Vec3::Zero();
      for (std::size_t k = 2 * v; k < 2 * v + 2; ++k) {
        const auto joint = static_cast<std::size_t>(model.influence_joints[k]);
        const auto weight = static_cast<double>(model.influence_weights[k]);
        const Vec3 local =
            model.positions[v].cast<double>() - model.skeleton.reference[joint].position;
        position += weight * (pose[joint].orientation * local + pose[joint].position);
        normal += weight * (pose[joint].orientation * model.normals[v].cast<double>());
      }
      to.positions[v] = position.cast<float>();
      if (!to.normals.empty()) to.normals[v] = normal.normalized().cast<float>();
    }
  });
  return motion;
}

void must(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  std::abort();
}

std::string write(const std::filesystem::path& path,
                  const std::function<Status(OutputFile&)>& content) {
  auto file = OutputFile::create(path.string());
  if (!file) std::abort();
  must(content(*file));
  must(file->commit());
  return path.string();
}

Scene read(const std::string& path) {
  auto file = gltf::read_file(path);
  if (!file) std::abort();
  auto scene = nodes::scene_of(std::make_shared<const nodes::Scene>(*std::move(file)));
  if (!scene) std::abort();
  return *std::move(scene);
}

compare::SceneDifference compare_files(const std::string& first, const std::string& second) {
  const Scene a = read(first);
  const Scene b = read(second);
  Progress quiet;
  auto found = compare::difference(a, b, {}, 1, quiet);
  if (!found) std::abort();
  return std::move(*found);
}

// Of the processor, so that what else the machine does counts less.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double seconds_of(const std::function<void()>& work) {
  const double begin = now();
  work();
  return now() - begin;
}

std::string hash_of(const compare::SceneDifference& found) {
  const double actors[] = {found.positions.largest,          found.positions.square_sum,
                           found.positions.percentile(0.95), found.normals.largest,
                           found.normals.square_sum,         found.normals.percentile(0.95)};
  return hex(xxh3(std::as_bytes(std::span(actors))));
}

void static_meshes(const std::filesystem::path& folder) {
  const Model model = make_tube(400, 250);
  Model other = model;
  for (std::size_t v = 0; v < other.positions.size(); ++v) {
    const auto noise = static_cast<float>(std::sin(12.9898 * static_cast<double>(v)));
    other.positions[v].x() += 2e-6F * noise;
    other.normals[v] = (other.normals[v] + Vec3f(0, 1e-5F * noise, 0)).normalized();
  }
  const auto file_of = [&](const Model& one, const char* name) {
    return write(folder / name, [&](OutputFile& file) {
      return gltf::write_mesh(one, {one.positions, one.normals, {}}, {}, file);
    });
  };
  const std::string first = file_of(model, "first.glb");
  const std::string second = file_of(other, "second.glb");
  double reading = 1e9, both = 1e9;
  compare::SceneDifference found;
  for (int round = 0; round < kRounds; ++round) {
    reading = std::min(reading, seconds_of([&] {
                         const auto a = gltf::read_file(first);
                         const auto b = gltf::read_file(second);
                       }));
    both = std::min(both, seconds_of([&] { found = compare_files(first, second); }));
  }
  std::printf("two GLB of %zu vertices: read %.1f ms, read and compared %.1f ms\n",
              model.positions.size(), 1e3 * reading, 1e3 * both);
  std::printf("read and compared / read: %.2f (at most 3)\n", both / reading);
  std::printf("hash of what was found: %s\n", hash_of(found).c_str());
}

void clips(const std::filesystem::path& folder) {
  constexpr int kFrames = 120;
  const Model model = make_tube(100, 100);
  const Clip clip = make_clip(model, kFrames);
  const std::string rig = write(
      folder / "rig.glb", [&](OutputFile& file) { return gltf::write_rig(model, clip, {}, file); });
  const std::string baked = write(folder / "baked.glb", [&](OutputFile& file) {
    return gltf::write_baked(model, skinned(model, clip), {}, file);
  });
  double best = 1e9;
  compare::SceneDifference found;
  for (int round = 0; round < 3; ++round) {
    best = std::min(best, seconds_of([&] { found = compare_files(rig, baked); }));
  }
  const double values = static_cast<double>(model.positions.size()) * kFrames;
  std::printf(
      "a rig against the same clip baked, %zu vertices x %d frames: %.0f ms, "
      "%.0f ns a vertex and frame; largest %.1e m\n",
      model.positions.size(), kFrames, 1e3 * best, 1e9 * best / values, found.positions.largest);
}

}  // namespace

int main() {
  const auto folder =
      std::filesystem::temp_directory_path() / ("compare_bench_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  static_meshes(folder);
  clips(folder);
  std::filesystem::remove_all(folder);
  return 0;
}
