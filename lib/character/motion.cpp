#include "character/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "capture/rest_frame.h"
#include "character/space.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "retarget/stance.h"
#include "scene/skeleton.h"

namespace krok::character {

using nodes::Scene;

namespace {

constexpr double kMaxTransforms = 1e8;
constexpr std::size_t kFramesAtOnce = 16;
constexpr double kStretchReported = 1e-3;  // if it is not kept
constexpr double kStretchKept = 1e-4;      // if any joint has more in any frame
constexpr double kStretchNoise = 1e-6;     // less is stored as none
constexpr double kUsualFieldOfView = kPi / 4;

Error overflow() {
  return Error("scene-value", "a joint or camera is over 1e9 m away",
               "the unit may be wrong; set it with --unit");
}

// The deviation of a linear part from a rotation: the largest relative change of an axis.
struct Deviation {
  double size = 0;
  int joint = -1;
};

double deviation_of(const Mat3& stretch) {
  return (stretch - Mat3::Identity()).colwise().norm().maxCoeff();
}

// Whether the stretches are worth keeping.
bool report_scale(const std::vector<Deviation>& worst_of_frames, const Rig& rig, bool kept,
                  Diagnostics& diagnostics) {
  Deviation worst;
  std::size_t frame = 0;
  for (std::size_t f = 0; f < worst_of_frames.size(); ++f) {
    if (!(worst_of_frames[f].size > worst.size * (1 + 1e-6))) continue;
    worst = worst_of_frames[f];
    frame = f;
  }
  if (worst.size < (kept ? kStretchKept : kStretchReported)) return false;
  Diagnostic diagnostic;
  diagnostic.severity = kept ? Severity::note : Severity::warning;
  diagnostic.code = "scene-scale";
  diagnostic.joint = rig.skeleton.names[at(worst.joint)];
  diagnostic.frame = static_cast<std::int64_t>(frame);
  diagnostic.message =
      fmt::format("joint scales differ from the bind pose{}; largest: {} by {}% in frame {}",
                  kept ? "" : " and are dropped, joint positions are kept", shown(diagnostic.joint),
                  readable(100 * worst.size, 3), frame);
  diagnostics.push_back(std::move(diagnostic));
  return true;
}

// The field of view of a perspective camera at a time of an animation. Splines may leave the range
// of angles between their keys.
double lens_at(const Scene& scene, int camera, int animation, double time) {
  const nodes::Camera& lens = scene.cameras[at(camera)];
  for (const nodes::Channel& channel : scene.animations[at(animation)].lenses) {
    if (channel.node != camera) continue;
    double angle = 0;
    nodes::sample(channel, time, {&angle, 1});
    return std::clamp(angle, 1e-3, kPi - 1e-3);
  }
  if (lens.lens.empty()) return lens.field_of_view;
  const auto last = static_cast<double>(lens.lens.size() - 1);
  double place = std::clamp(time * lens.lens_rate, 0.0, last);
  // Key times are floats: snap to frames.
  if (std::abs(place - std::round(place)) < 1e-4) place = std::round(place);
  const auto before = static_cast<std::size_t>(place);
  const double after = static_cast<double>(lens.lens[std::min(before + 1, lens.lens.size() - 1)]);
  const double share = place - static_cast<double>(before);
  return (1 - share) * static_cast<double>(lens.lens[before]) + share * after;
}

// The frames at which a new shot begins: where the camera's node jumps, at a step or between keys
// that are much nearer to each other than to the one before.
std::vector<int> cuts_of(const nodes::Animation& animation, int node, const Sampling& sampling) {
  std::vector<int> cuts;
  for (const nodes::Channel& channel : animation.channels) {
    if (channel.node != node || channel.interpolation == nodes::Interpolation::cubic_spline)
      continue;
    const std::vector<float>& times = *channel.times;
    for (std::size_t key = 1; key < times.size(); ++key) {
      const auto value = [&](std::size_t k) {
        return std::span(*channel.values).subspan(k * at(channel.width), at(channel.width));
      };
      const bool near =
          key > 1 && times[key] - times[key - 1] < 0.05f * (times[key - 1] - times[key - 2]);
      if (channel.interpolation != nodes::Interpolation::step && !near) continue;
      if (std::ranges::equal(value(key - 1), value(key))) continue;
      // Key times are floats: snap to frames.
      const double place = (static_cast<double>(times[key]) - sampling.start) / sampling.step;
      const double frame = std::ceil(place - 1e-4);
      if (frame >= 1 && frame < sampling.frames) cuts.push_back(static_cast<int>(frame));
    }
  }
  std::ranges::sort(cuts);
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

}  // namespace

Result<Skeleton> skeleton_in_krok(const Rig& rig, const Conversion& conversion) {
  Skeleton skeleton = rig.skeleton;
  for (Transform& joint : skeleton.reference) {
    joint = conversion.reference(joint);
    if (!is_near(joint.position)) return overflow();
  }
  return skeleton;
}

Result<Clip> make_clip(const nodes::Evaluator& evaluator, const Rig& rig,
                       const Conversion& conversion, int animation, const Sampling& sampling,
                       int jobs, Progress* progress, Diagnostics& diagnostics,
                       Stretches* stretches) {
  auto skeleton = skeleton_in_krok(rig, conversion);
  if (!skeleton) return skeleton.error();
  const double transforms = static_cast<double>(sampling.frames) * rig.joints.count();
  if (transforms > kMaxTransforms) {
    return Error("scene-too-long",
                 fmt::format("{} frames of {} joints exceed the limit of 100 million transforms",
                             sampling.frames, rig.joints.count()),
                 "use --rate N for a lower frame rate");
  }
  Clip clip;
  clip.skeleton = std::move(*skeleton);
  clip.rate = sampling.rate;
  clip.resize(sampling.frames);
  if (stretches != nullptr) stretches->assign(clip.positions.size(), Stretch());
  std::vector<Deviation> deviations(at(sampling.frames));
  std::atomic<bool> finite = true;
  if (progress != nullptr) progress->begin("reading frames", deviations.size());
  parallel_for(deviations.size(), kFramesAtOnce, jobs, [&](std::size_t begin, std::size_t end) {
    nodes::Evaluation state;
    std::vector<Transform> pose(at(rig.joints.count()));
    for (std::size_t frame = begin; frame < end; ++frame) {
      evaluator.place_nodes(animation, sampling.time(static_cast<int>(frame)), state);
      Deviation& worst = deviations[frame];
      for (int j = 0; j < rig.joints.count(); ++j) {
        const Mat4 placed = rig.joint_to_world(state, j);
        const Transform rigid = nodes::rigid_part(placed);
        const Mat3 stretch =
            rigid.orientation.toRotationMatrix().transpose() * placed.topLeftCorner<3, 3>();
        const double deviation = deviation_of(stretch);
        if (deviation > worst.size * (1 + 1e-6)) worst = {deviation, j};
        pose[at(j)] = conversion.pose(rigid);
        if (!is_near(pose[at(j)].position)) finite = false;
        if (stretches == nullptr || deviation < kStretchNoise) continue;
        const Mat3& axes = conversion.reference_axes();
        Stretch& kept = (*stretches)[frame * pose.size() + at(j)];
        kept = Stretch::of(axes * stretch * axes.transpose());
        if (!kept.matrix().allFinite()) finite = false;
      }
      clip.set_pose(static_cast<int>(frame), pose);
    }
    if (progress != nullptr) progress->advance(end - begin);
  });
  if (progress != nullptr) progress->end();
  if (!finite) return overflow();
  if (!report_scale(deviations, rig, stretches != nullptr, diagnostics) && stretches != nullptr) {
    stretches->clear();
  }
  return clip;
}

std::vector<Vec3> sample_positions(const nodes::Evaluator& evaluator, const Rig& rig, int animation,
                                   const Sampling& sampling, int most) {
  std::vector<Vec3> positions;
  nodes::Evaluation state;
  const int limit = std::max(1, most);
  const int step = sampling.frames / limit + (sampling.frames % limit > 0 ? 1 : 0);
  for (int frame = 0; frame < sampling.frames; frame += std::max(1, step)) {
    evaluator.place_nodes(animation, sampling.time(frame), state);
    for (int j = 0; j < rig.joints.count(); ++j) {
      positions.push_back(rig.joint_to_world(state, j).topRightCorner<3, 1>());
    }
  }
  return positions;
}

std::vector<int> camera_nodes(const Scene& scene, const nodes::Evaluator& evaluator) {
  std::vector<int> found;
  for (const int node : evaluator.order()) {
    const nodes::Node& one = scene.nodes[at(node)];
    if (one.camera >= 0 && one.in_scene) found.push_back(node);
  }
  return found;
}

Result<CameraTrack> make_camera(const Scene& scene, const nodes::Evaluator& evaluator, int node,
                                const Conversion& conversion, const Mat4& to_axes, int animation,
                                const Sampling& sampling, Diagnostics& diagnostics) {
  const nodes::Camera& lens = scene.cameras[at(scene.nodes[at(node)].camera)];
  double field_of_view = lens.field_of_view;
  if (!lens.perspective) {
    field_of_view = kUsualFieldOfView;
    diagnostics.push_back(
        make_warning("scene-camera",
                     fmt::format("{} is orthographic and has no field of view; 45 degrees is used",
                                 label("camera", scene.nodes[at(node)].camera, lens.name))));
  }
  CameraTrack track;
  track.rate = sampling.rate;
  if (animation >= 0) track.cuts = cuts_of(scene.animations[at(animation)], node, sampling);
  nodes::Evaluation state;
  // A camera has no reference pose: only the rotation to world axes applies.
  const Quat turn =
      conversion.reference_to_motion().orientation * Quat(conversion.reference_axes());
  for (int frame = 0; frame < sampling.frames; ++frame) {
    evaluator.place_nodes(animation, sampling.time(frame), state);
    const Transform placed = nodes::rigid_part(to_axes * state.node_to_world[at(node)]);
    const Transform position = conversion.pose({placed.position, Quat::Identity()});
    if (!is_near(position.position)) return overflow();
    track.positions.push_back(position.position.cast<float>());
    track.orientations.push_back((turn * placed.orientation).cast<float>().normalized());
    const bool changes = lens.perspective && animation >= 0;
    track.fields_of_view.push_back(static_cast<float>(
        changes ? lens_at(scene, scene.nodes[at(node)].camera, animation, sampling.time(frame))
                : field_of_view));
  }
  return track;
}

Result<Rig> find_rig(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                     const std::string& skin, Diagnostics& diagnostics) {
  auto joints = choose_joints(scene, evaluator, skin, diagnostics);
  if (!joints) return joints.error();
  return make_rig(scene, evaluator, *std::move(joints), diagnostics);
}

Result<Conventions> scene_conventions(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                      const Rig* rig, const RoleMap& roles, int animation,
                                      const GivenConventions& given) {
  constexpr int kMaxSamples = 200;
  std::vector<Vec3> samples;
  if (rig != nullptr && animation >= 0) {
    Diagnostics reported_elsewhere;
    const auto sampling = choose_sampling(scene.animations[at(animation)], {}, reported_elsewhere);
    if (!sampling) return sampling.error();
    samples = sample_positions(evaluator, *rig, animation, sampling->sampling, kMaxSamples);
  }
  return find_conventions(scene.space, rig, roles, samples, given);
}

Result<ScenePlace> place_scene(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                               const Rig* rig, const RoleMap& roles, int animation,
                               const CaptureOptions& how, const std::string& path,
                               Diagnostics& diagnostics) {
  const auto conventions = scene_conventions(scene, evaluator, rig, roles, animation, how);
  if (!conventions) return conventions.error();
  const auto conversion = Conversion::make(*conventions);
  if (!conversion) return conversion.error();
  GivenConventions said = how;  // from the user or the file
  if (scene.space.metres) said.unit = conventions->unit;
  if (scene.space.up_is_y) said.up = conventions->up;
  if (scene.space.file_to_krok) {
    said.up = conventions->up;
    said.forward = conventions->forward;
  }
  report_conventions(*conventions, said, "scene", path, diagnostics);
  if (rig != nullptr) {
    const auto skeleton = skeleton_in_krok(*rig, *conversion);
    if (!skeleton) return skeleton.error();
    if (said.unit) check_size(*skeleton, roles, diagnostics);
    const bool any_pose = !rig->has_mesh && retarget::is_frame_of_motion(*skeleton, roles);
    if (said.complete() && !any_pose) check_actor(*skeleton, roles, diagnostics);
  }
  return ScenePlace{*conventions, *conversion, describe_conversions(*conventions, how)};
}

Result<Clip> make_motion(const nodes::Evaluator& evaluator, const Rig& rig, const RoleMap& roles,
                         const ScenePlace& place, int animation, const ChosenSampling& sampling,
                         int jobs, Progress* progress, Diagnostics& diagnostics,
                         Stretches* stretches) {
  auto clip = make_clip(evaluator, rig, place.conversion, animation, sampling.sampling, jobs,
                        progress, diagnostics, stretches);
  if (!clip) return clip;
  if (const RestPose rest = find_rest_pose(*clip, roles); rest.frames > 0) {
    diagnostics.push_back(make_warning(
        "import-rest-frame", rest.reason + (rest.frames > 1 ? "; they were kept" : "; it was kept"),
        fmt::format("drop {} with krok-edit --from {}f", rest.frames > 1 ? "them" : "it",
                    rest.frames)));
  }
  if (!rig.has_mesh && retarget::is_frame_of_motion(clip->skeleton, roles)) {
    clip->skeleton.reference = retarget::stance_from_frame(*clip, roles);
    diagnostics.push_back(make_diagnostic(
        Severity::note, "scene-pose",
        "the file has no mesh, and without animation its nodes are in a pose amid a motion; a "
        "T-pose made from the motion is the reference pose"));
  }
  clip->provenance.conversions = place.conversions;
  clip->provenance.conversions.push_back(
      fmt::format("keys sampled at {} frames per second from {} s on",
                  readable(1 / sampling.sampling.step), readable(sampling.keys_from)));
  return clip;
}

}  // namespace krok::character
