#include "motion/travel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"

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

std::vector<Jump> jumps_of(std::span<const Vec3f> track, double rate) {
  constexpr double kJumps = 8, kTooFast = 10;  // times the median step; metres per second
  std::vector<double> steps;
  for (std::size_t f = 1; f < track.size(); ++f) {
    steps.push_back((track[f] - track[f - 1]).cast<double>().norm());
  }
  std::vector<Jump> jumps;
  if (steps.empty()) return jumps;
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double max_step = std::max(kJumps * *middle, kTooFast / rate);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > max_step) jumps.push_back({static_cast<int>(i) + 1, steps[i]});
  }
  return jumps;
}

std::vector<Jump> jumps_of(const Clip& clip, int joint) {
  std::vector<Vec3f> track;
  track.reserve(at(clip.frame_count()));
  for (int f = 0; f < clip.frame_count(); ++f) track.push_back(clip.frame_positions(f)[at(joint)]);
  return jumps_of(track, clip.rate);
}

Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints) {
  return largest_displacement(before, after, joints, 0, before.frame_count());
}

Displacement largest_displacement(const Clip& before, const Clip& after,
                                  std::span<const int> joints, int begin, int end) {
  assert(before.positions.size() == after.positions.size());
  Displacement largest;
  for (int f = begin; f < end; ++f) {
    const auto from = before.frame_positions(f), to = after.frame_positions(f);
    for (const int j : joints) {
      const auto at = static_cast<std::size_t>(j);
      const double distance = (to[at].cast<double>() - from[at].cast<double>()).norm();
      if (distance > largest.distance) largest = {distance, j, f};
    }
  }
  return largest;
}

void move_clip(const Transform& world_to_world, Clip& clip) {
  const Transform& move = world_to_world;
  const bool turns = move.orientation.vec().squaredNorm() > 0;
  for (Vec3f& position : clip.positions) position = (move * position.cast<double>()).cast<float>();
  if (!turns) return;
  for (Quatf& orientation : clip.orientations) {
    orientation =
        normalized_or_identity(move.orientation * orientation.cast<double>()).cast<float>();
  }
}

Transform to_origin(const Clip& clip, int carrier) {
  Transform move;
  if (clip.frame_count() == 0) return move;
  const GroundFrame place = ground_frame(clip, carrier, 0);
  move.position = Vec3(-place.x, 0, -place.z);
  return move;
}

Transform turned_about_start(const Clip& clip, int carrier, double angle) {
  Transform move;
  if (clip.frame_count() == 0 || angle == 0) return move;
  const GroundFrame place = ground_frame(clip, carrier, 0);
  const Vec3 centre(place.x, 0, place.z);
  move.orientation = axis_rotation(Axis::y, angle);
  move.position = centre - move.orientation * centre;
  return move;
}

Transform facing_at_start(const Clip& clip, int carrier, double heading) {
  if (clip.frame_count() == 0) return {};
  return turned_about_start(clip, carrier,
                            wrapped(heading - ground_frame(clip, carrier, 0).heading));
}

Transform onto_ground(const Clip& clip, std::span<const int> joints) {
  Transform move;
  float lowest = std::numeric_limits<float>::infinity();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const auto positions = clip.frame_positions(f);
    for (const int j : joints)
      lowest = std::min(lowest, positions[static_cast<std::size_t>(j)].y());
  }
  if (std::isfinite(lowest)) move.position.y() = -static_cast<double>(lowest);
  return move;
}

Status scale_clip(double factor, Clip& clip) {
  if (!(factor > 0) || !std::isfinite(factor)) {
    return Error("motion-scale", fmt::format("cannot scale a motion by {}", factor),
                 "the factor must be a positive number");
  }
  const auto scaled = [&](const Vec3f& position) {
    return Vec3f((factor * position.cast<double>()).cast<float>());
  };
  const bool fits =
      std::ranges::all_of(clip.positions,
                          [&](const Vec3f& position) { return scaled(position).allFinite(); }) &&
      std::ranges::all_of(clip.skeleton.reference, [&](const Transform& joint) {
        return (factor * joint.position).cast<float>().allFinite();
      });
  if (!fits) {
    return Error("motion-scale",
                 fmt::format("positions scaled by {} exceed the range of a float", factor));
  }
  for (Vec3f& position : clip.positions) position = scaled(position);
  for (Transform& joint : clip.skeleton.reference) joint.position *= factor;
  return {};
}

double reference_height(const Skeleton& skeleton) {
  if (skeleton.empty()) return 0;
  const auto [low, high] = std::ranges::minmax_element(
      skeleton.reference, {}, [](const Transform& joint) { return joint.position.y(); });
  return high->position.y() - low->position.y();
}

}  // namespace krok
