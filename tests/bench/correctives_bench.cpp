// What shapes by pose cost in skinning: the weights of the pose, the morph targets and linear blend
// skinning, beside the same morph targets with given weights and the same skinning. Rounds take
// turns and the fastest of each counts; printed are the ratio, times of this machine and a hash.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "body/body.h"
#include "core/hash.h"
#include "correctives/fit_correctives.h"
#include "math/quaternion.h"
#include "samples/generator/walk.h"
#include "skin/morph.h"

namespace {

using namespace krok;

std::vector<Transform> bent(const Skeleton& skeleton, int joint, double angle) {
  std::vector<Transform> pose = skeleton.reference;
  const Vec3 centre = pose[static_cast<std::size_t>(joint)].position;
  const Quat turn = from_rotation_vector(Vec3(0.2 * angle, -angle, 0.1 * angle));
  std::vector<char> moves(pose.size(), 0);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const int parent = skeleton.parents[j];
    moves[j] = static_cast<int>(j) == joint ||
               (parent >= 0 && moves[static_cast<std::size_t>(parent)] != 0);
    if (moves[j] == 0) continue;
    pose[j] = {turn * (pose[j].position - centre) + centre, turn * pose[j].orientation};
  }
  return pose;
}

}  // namespace

int main() {
  const auto walk = samples::make_walk({});
  if (!walk) return 1;
  const auto body = make_body(walk->clip);
  if (!body) return 1;
  const Model& model = body->model;
  const SkinBinding sculptor(model, SkinMethod::dual_quaternion),
      binding(model, SkinMethod::linear);
  SkinPose sculpt(sculptor), pose(binding);
  std::vector<SculptedJoint> joints;
  for (const char* name : {"LeftForeArm", "RightForeArm", "LeftLeg", "RightLeg"}) {
    SculptedJoint& joint = joints.emplace_back();
    joint.joint = model.skeleton.find(name);
    for (const double angle : {0.5, 1.0, 1.5, 1.9, 2.3}) {
      SculptedPose& example = joint.examples.emplace_back();
      example.joint_to_world = bent(model.skeleton, joint.joint, angle);
      sculpt.set(example.joint_to_world);
      example.positions.resize(model.positions.size());
      skin(sculptor, sculpt, {model.positions, {}, {}}, {example.positions, {}, {}});
    }
  }
  const auto fit = fit_correctives(model, SkinMethod::linear, joints);
  if (!fit) return 1;
  const auto by_pose = CorrectiveWeights::create(fit->correctives, model.skeleton);
  const MorphSet targets = targets_of(fit->correctives, model);
  const auto now = bent(model.skeleton, joints[0].joint, 1.3);
  std::vector<float> weights(targets.names.size());
  by_pose->at(now, weights);
  const std::vector<float> given = weights;
  std::vector<Vec3f> positions(model.positions.size()), normals(positions.size());
  std::vector<Vec3f> moved(positions.size()), turned(positions.size());
  const auto play = [&](std::span<const float> with) {
    apply_morphs(targets, with, {model.positions, model.normals}, {positions, normals});
    pose.set(now);
    skin(binding, pose, {positions, normals, {}}, {moved, turned, {}});
  };
  double plain = 1e9, corrected = 1e9;
  for (int round = 0; round < 300; ++round) {
    const auto start = std::chrono::steady_clock::now();
    play(given);
    const auto middle = std::chrono::steady_clock::now();
    by_pose->at(now, weights);
    play(weights);
    const auto end = std::chrono::steady_clock::now();
    plain = std::min(plain, std::chrono::duration<double>(middle - start).count());
    corrected = std::min(corrected, std::chrono::duration<double>(end - middle).count());
  }
  std::printf("%d vertices, %d targets of %zu joints\n", model.vertex_count(),
              targets.target_count(), joints.size());
  std::printf("  microseconds: given weights %.1f, weights by pose %.1f\n", plain * 1e6,
              corrected * 1e6);
  std::printf("  weights by pose / given weights %.3f, hash %s\n", corrected / plain,
              hex(xxh3(std::as_bytes(std::span(moved)))).c_str());
  return 0;
}
