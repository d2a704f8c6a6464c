// Poses of 60 joints. Eight clips sampled at warped times and blended, with the sign rule and the
// normalisation, and local to model: the kernels of lib/pose beside plain C++ versions that keep a
// joint as a struct, compiled in this program with the same flags and doing the same mathematics.
// Rounds of all of them take turns and the fastest of each counts; what is printed are ratios,
// which compare across machines, times of this one, and a hash of the results.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/simd.h"
#include "math/quaternion.h"
#include "pose/packed_pose.h"
#include "support/test_scenes.h"

namespace {

using namespace krok;

constexpr int kJoints = 60;
constexpr int kClips = 8;
constexpr int kFrames = 64;  // about a step of a walk
constexpr int kPoses = 64;   // a round
constexpr double kRate = 60;

// The plain version: an array of structures.
struct PlainJoint {
  float position[3];
  float rotation[4];  // x, y, z, w
};
struct PlainClip {
  std::vector<PlainJoint> joints;  // [frames x joints], relative to the parent
};
struct PlainMatrix {
  float rows[3][4];
};

float dot(const float* a, const float* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

void plain_blend(const std::vector<PlainClip>& clips, const double* times, const float* weights,
                 const PlainJoint* reference, PlainJoint* pose) {
  for (int j = 0; j < kJoints; ++j) pose[j] = {};
  for (int c = 0; c < kClips; ++c) {
    const double wanted = std::clamp(times[c] * kRate, 0.0, kFrames - 1.0);
    const int frame = std::min(static_cast<int>(wanted), kFrames - 2);
    const auto part = static_cast<float>(wanted - frame);
    const float rest = 1 - part;
    const float weight = weights[c];
    const PlainJoint* before = clips[static_cast<std::size_t>(c)].joints.data() +
                               static_cast<std::ptrdiff_t>(frame) * kJoints;
    const PlainJoint* after = before + kJoints;
    for (int j = 0; j < kJoints; ++j) {
      for (int i = 0; i < 3; ++i) {
        pose[j].position[i] +=
            weight * (rest * before[j].position[i] + part * after[j].position[i]);
      }
      float q[4];
      for (int i = 0; i < 4; ++i) q[i] = rest * before[j].rotation[i] + part * after[j].rotation[i];
      float factor = weight / std::sqrt(dot(q, q));
      if (dot(q, reference[j].rotation) < 0) factor = -factor;
      for (int i = 0; i < 4; ++i) pose[j].rotation[i] += factor * q[i];
    }
  }
  for (int j = 0; j < kJoints; ++j) {
    const float square = dot(pose[j].rotation, pose[j].rotation);
    if (!(square > 1e-12f)) {
      std::copy_n(reference[j].rotation, 4, pose[j].rotation);
      continue;
    }
    const float scale = 1 / std::sqrt(square);
    for (float& value : pose[j].rotation) value *= scale;
  }
}

PlainMatrix matrix_of(const PlainJoint& joint) {
  const float x = joint.rotation[0], y = joint.rotation[1], z = joint.rotation[2],
              w = joint.rotation[3];
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), joint.position[0]},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), joint.position[1]},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), joint.position[2]}}};
}

void plain_local_to_model(const int* parents, const PlainJoint* pose, PlainMatrix* model) {
  for (int j = 0; j < kJoints; ++j) {
    const PlainMatrix local = matrix_of(pose[j]);
    if (parents[j] < 0) {
      model[j] = local;
      continue;
    }
    const PlainMatrix& parent = model[parents[j]];
    for (int r = 0; r < 3; ++r) {
      const float* a = parent.rows[r];
      float* out = model[j].rows[r];
      for (int c = 0; c < 4; ++c) {
        out[c] = a[0] * local.rows[0][c] + a[1] * local.rows[1][c] + a[2] * local.rows[2][c];
      }
      out[3] += a[3];
    }
  }
}

struct Scene {
  Skeleton skeleton;
  std::vector<PackedClip> clips;
  std::vector<PlainClip> plain_clips;
  std::vector<PoseBlock> reference;
  std::vector<PlainJoint> plain_reference;
  // [poses x clips]
  std::vector<double> times;
  std::vector<float> weights;
  // What comes out; the blended poses go into local to model.
  std::vector<PoseBlock> poses, scratch;
  std::vector<PlainJoint> plain_poses;
  std::vector<JointMatrix> matrices;
  std::vector<PlainMatrix> plain_matrices;
  std::vector<Vec3f> positions;
  std::vector<Quatf> orientations;
};

std::vector<PlainJoint> plain(std::span<const PoseBlock> poses, int count) {
  std::vector<PlainJoint> result;
  const std::size_t blocks = pose_blocks(kJoints);
  for (std::size_t p = 0; p < static_cast<std::size_t>(count); ++p) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const PoseBlock& block = poses[p * blocks + j / PoseBlock::kLanes];
      const std::size_t lane = j % PoseBlock::kLanes;
      PlainJoint joint{};
      for (int i = 0; i < 3; ++i) joint.position[i] = block.position[i][lane];
      for (int i = 0; i < 4; ++i) joint.rotation[i] = block.rotation[i][lane];
      result.push_back(joint);
    }
  }
  return result;
}

Scene make_scene() {
  Scene scene;
  // A figure's joints, and chains as fingers have them up to 60.
  scene.skeleton = test::with_turned_joints(test::human_skeleton());
  while (scene.skeleton.joint_count() < kJoints) {
    const int j = scene.skeleton.joint_count();
    const int parent = j % 3 == 0 ? 10 : j - 1;
    Transform place = scene.skeleton.reference[static_cast<std::size_t>(parent)];
    place.position += Vec3(0.03, 0, 0.01);
    scene.skeleton.add("more" + std::to_string(j), parent, place);
  }
  scene.reference = packed_reference(scene.skeleton);
  scene.plain_reference = plain(scene.reference, 1);
  for (int c = 0; c < kClips; ++c) {
    const Clip clip = test::swinging_clip(scene.skeleton, kFrames, kRate * (1 + 0.1 * c));
    scene.clips.push_back(pack_clip(clip));
    scene.clips.back().rate = kRate;
    scene.plain_clips.push_back({plain(scene.clips.back().blocks, kFrames)});
  }
  // Times that all clips pass through at a pace of their own, as by keytimes.
  for (int p = 0; p < kPoses; ++p) {
    for (int c = 0; c < kClips; ++c) {
      const double generic = static_cast<double>(p) / kPoses;
      const double warped = generic + 0.1 * std::sin(2 * kPi * generic + c);
      scene.times.push_back(std::clamp(warped, 0.0, 1.0) * (kFrames - 1) / kRate);
      scene.weights.push_back(1.0f / kClips);
    }
  }
  const std::size_t blocks = scene.reference.size();
  scene.poses.resize(kPoses * blocks);
  scene.scratch.resize(static_cast<std::size_t>(model_scratch(kJoints)));
  scene.plain_poses.resize(static_cast<std::size_t>(kPoses) * kJoints);
  scene.matrices.resize(scene.plain_poses.size());
  scene.plain_matrices.resize(scene.plain_poses.size());
  scene.positions.resize(scene.plain_poses.size());
  scene.orientations.resize(scene.plain_poses.size());
  return scene;
}

void blend_all(Scene& scene) {
  const std::size_t blocks = scene.reference.size();
  BlendTerm terms[kClips];
  for (std::size_t p = 0; p < kPoses; ++p) {
    for (std::size_t c = 0; c < kClips; ++c) {
      terms[c] = {&scene.clips[c], scene.times[p * kClips + c], scene.weights[p * kClips + c]};
    }
    blend_poses(terms, scene.reference, std::span(scene.poses).subspan(p * blocks, blocks));
  }
}

void plain_blend_all(Scene& scene) {
  for (std::size_t p = 0; p < kPoses; ++p) {
    plain_blend(scene.plain_clips, scene.times.data() + p * kClips,
                scene.weights.data() + p * kClips, scene.plain_reference.data(),
                scene.plain_poses.data() + p * kJoints);
  }
}

struct Part {
  std::string name;
  double items;  // a round
  std::function<void()> run;
  double best = 1e9;  // seconds a round
  double nanoseconds() const { return best / items * 1e9; }
};

// Rounds in turn, so that what slows the machine for a while slows all alike.
void measure(std::vector<Part>& parts) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 400;
  for (int round = 0; round < kRounds; ++round) {
    for (Part& part : parts) {
      const auto begin = Clock::now();
      part.run();
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      part.best = std::min(part.best, seconds);
    }
  }
}

// The largest difference between what the kernels and the plain versions made.
double largest_difference(const Scene& scene) {
  double largest = 0;
  for (std::size_t i = 0; i < scene.matrices.size(); ++i) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) {
        const double difference =
            double{scene.matrices[i].rows[r][c]} - double{scene.plain_matrices[i].rows[r][c]};
        largest = std::max(largest, std::abs(difference));
      }
    }
  }
  return largest;
}

}  // namespace

int main() {
  Scene scene = make_scene();
  const LocalPoses local{scene.skeleton.parents, scene.poses, scene.scratch};
  constexpr double kJointsARound = double{kPoses} * kJoints;
  std::vector<Part> parts = {
      {"blend of 8 clips, plain", kJointsARound * kClips, [&] { plain_blend_all(scene); }},
      {"blend of 8 clips", kJointsARound * kClips, [&] { blend_all(scene); }},
      {"local to model, plain matrices", kJointsARound,
       [&] {
         for (std::size_t p = 0; p < kPoses; ++p) {
           plain_local_to_model(scene.skeleton.parents.data(),
                                scene.plain_poses.data() + p * kJoints,
                                scene.plain_matrices.data() + p * kJoints);
         }
       }},
      {"local to model, matrices", kJointsARound, [&] { local_to_model(local, scene.matrices); }},
      {"local to model, as a clip", kJointsARound,
       [&] { local_to_model(local, scene.positions, scene.orientations); }}};
  // What a machine without AVX-512 has of it.
  const bool has_avx512 = limit_simd(Simd::avx512) == Simd::avx512;
  const auto with_avx2 = [](const auto& run) {
    limit_simd(Simd::avx2);
    run();
    limit_simd(Simd::avx512);
  };
  if (has_avx512) {
    parts.push_back({"blend of 8 clips, AVX2", kJointsARound * kClips,
                     [&] { with_avx2([&] { blend_all(scene); }); }});
    parts.push_back({"local to model, matrices, AVX2", kJointsARound,
                     [&] { with_avx2([&] { local_to_model(local, scene.matrices); }); }});
  }
  measure(parts);
  for (const Part& part : parts) {
    std::printf("%-32s %6.2f ns a joint%s\n", part.name.c_str(), part.nanoseconds(),
                part.items > kJointsARound ? " and clip" : "");
  }
  std::printf("blend, plain / kernel: %.1f\n", parts[0].best / parts[1].best);
  std::printf("local to model, plain / kernel to matrices: %.1f\n", parts[2].best / parts[3].best);
  std::printf("local to model, plain / kernel to a clip: %.1f\n", parts[2].best / parts[4].best);
  if (has_avx512) {
    std::printf("with AVX2, plain / kernel: %.1f and %.1f\n", parts[0].best / parts[5].best,
                parts[2].best / parts[6].best);
  }
  std::printf("largest difference between them: %.1e\n", largest_difference(scene));
  std::printf("hash of the blended poses: %s, of the matrices: %s\n",
              hex(xxh3(std::as_bytes(std::span(scene.poses)))).c_str(),
              hex(xxh3(std::as_bytes(std::span(scene.matrices)))).c_str());
  return 0;
}
