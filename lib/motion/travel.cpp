#include "motion/travel.h"

#include <cmath>
#include <map>

#include "core/index.h"
#include "math/euler.h"
#include "motion/ground_frame.h"
#include "scene/frame_blocks.h"

namespace krok {

namespace {

// The topmost joint that travels, from the carrier upwards; the carrier if none does.
Result<int> top_traveller(const FrameSource& source, int carrier, int jobs) {
  constexpr float kStillMetres = 1e-3f;
  const std::vector<int>& parents = source.skeleton.parents;
  std::map<int, Eigen::AlignedBox2f> above;  // where joints are over the ground
  for (int j = parents[at(carrier)]; j >= 0; j = parents[at(j)]) above[j];
  if (above.empty()) return carrier;
  const Status status = for_each_block(source, jobs, [&](int, const Clip& block) {
    for (int f = 0; f < block.frame_count(); ++f) {
      for (auto& [joint, box] : above) {
        const Vec3f& position = block.frame_positions(f)[at(joint)];
        box.extend(Eigen::Vector2f(position.x(), position.z()));
      }
    }
    return Status();
  });
  if (!status) return status.error();
  for (const auto& [joint, box] : above) {  // parents first
    if (box.sizes().maxCoeff() > kStillMetres) return joint;
  }
  return carrier;
}

Result<GroundFrame> ground_frame(const FrameSource& source, int carrier, int frame) {
  const auto clip = load(part_of(source, frame, 1), 1);
  if (!clip) return clip.error();
  return ground_frame(*clip, carrier, 0);
}

}  // namespace

Clip in_place(const Clip& clip, int carrier, Travel removed) {
  // Frames of a clip are always there.
  Clip result = *load(*in_place(frames_of(clip), carrier, removed, 1), 1);
  result.provenance = clip.provenance;
  return result;
}

Result<FrameSource> in_place(const FrameSource& source, int carrier, Travel removed, int jobs) {
  const int last = source.frame_count - 1;
  if (last < 1) return source;
  const auto top = top_traveller(source, carrier, jobs);
  if (!top) return top.error();
  const auto first = ground_frame(source, carrier, 0), end = ground_frame(source, carrier, last);
  if (!first) return first.error();
  if (!end) return end.error();
  FrameSource result = source;
  result.read = [=, within = subtree(source.skeleton, *top), from = *first, to = *end](
                    int begin, int count, std::span<Vec3f> positions,
                    std::span<Quatf> orientations) -> Status {
    const auto part = load(part_of(source, begin, count), 1);
    if (!part) return part.error();
    std::ranges::copy(part->positions, positions.begin());
    std::ranges::copy(part->orientations, orientations.begin());
    for (int f = 0; f < count; ++f) {
      const GroundFrame now = krok::ground_frame(*part, carrier, f);
      const double share = static_cast<double>(begin + f) / last;
      const Vec3 travel = removed == Travel::all
                              ? Vec3(now.x - from.x, 0, now.z - from.z)
                              : Vec3(share * (to.x - from.x), 0, share * (to.z - from.z));
      const auto places = positions.subspan(at(f) * within.size(), within.size());
      for (std::size_t j = 0; j < places.size(); ++j) {
        if (within[j]) places[j] = (places[j].cast<double>() - travel).cast<float>();
      }
    }
    return {};
  };
  return result;
}

Clip carried_along(const Clip& clip, int carrier, const RootMotion& added) {
  Clip result = clip;
  result.provenance.removed_root_motion.reset();
  if (clip.frame_count() == 0) return result;
  const GroundFrame start = ground_frame(clip, carrier, 0);
  const Vec3 pivot(start.x, 0, start.z);
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 1; f < clip.frame_count(); ++f) {
    const double time = f / clip.rate;
    const double angle = added.turn_rate * time;
    const Quat turn = axis_rotation(Axis::y, angle);
    // The integral of the turning velocity: the chord, at the mean heading.
    const double chord = std::abs(angle) < 1e-6 ? 1 : std::sin(angle / 2) / (angle / 2);
    const Vec3 way = chord * time * (axis_rotation(Axis::y, angle / 2) * added.velocity);
    const Transform move{pivot + way - turn * pivot, turn};
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = move * joint;
    result.set_pose(f, pose);
  }
  return result;
}

std::optional<Clip> travelling(const Clip& clip, int carrier) {
  const auto& removed = clip.provenance.removed_root_motion;
  if (!removed) return std::nullopt;
  return carried_along(clip, carrier, *removed);
}

}  // namespace krok
