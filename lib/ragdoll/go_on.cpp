#include "ragdoll/simulate.h"

#include <algorithm>
#include <vector>

#include "core/index.h"
#include "math/quaternion.h"
#include "timeline/join_state.h"

namespace krok::ragdoll {

namespace {

using Local = std::vector<Transform>;  // joint_to_parent

Local local_pose(const Clip& clip, int frame) {
  Local pose(clip.skeleton.names.size()), local(pose.size());
  clip.get_pose(frame, pose);
  world_to_local(clip.skeleton.parents, pose, local);
  return local;
}

// Of a joint at a frame, from the two before it as far as there are.
struct JointRates {
  timeline::Rates turn, shift;
};

std::vector<JointRates> rates_at(const Clip& clip, int frame) {
  const int known = std::min(frame, 2);
  const double step = -1 / clip.rate;
  const Local now = local_pose(clip, frame);
  const Local one = local_pose(clip, std::max(0, frame - 1));
  const Local two = local_pose(clip, std::max(0, frame - 2));
  std::vector<JointRates> rates;
  for (std::size_t j = 0; j < now.size(); ++j) {
    const auto turned = [&](const Local& other) {
      return rotation_vector(other[j].orientation * now[j].orientation.conjugate());
    };
    rates.push_back({timeline::rates_of(turned(one), turned(two), step, known),
                     timeline::rates_of(one[j].position - now[j].position,
                                        two[j].position - now[j].position, step, known)});
  }
  return rates;
}

struct Offset {
  timeline::Decay turn, shift;
};

std::vector<Offset> offsets_at(const Clip& simulated, const Clip& motion, int frame, double span) {
  const Local from = local_pose(simulated, frame), to = local_pose(motion, frame);
  const auto from_rates = rates_at(simulated, frame), to_rates = rates_at(motion, frame);
  std::vector<Offset> offsets;
  for (std::size_t j = 0; j < from.size(); ++j) {
    const auto turn = timeline::rotation_offset(from[j].orientation, from_rates[j].turn,
                                                to[j].orientation, to_rates[j].turn);
    const timeline::Rates shift{from_rates[j].shift.velocity - to_rates[j].shift.velocity,
                                from_rates[j].shift.acceleration - to_rates[j].shift.acceleration};
    offsets.push_back({timeline::Decay(turn.value, turn.rates, span, false),
                       timeline::Decay(from[j].position - to[j].position, shift, span, false)});
  }
  return offsets;
}

}  // namespace

Result<Clip> go_on(const Clip& simulated, const Clip& motion, double span) {
  if (simulated.skeleton.parents != motion.skeleton.parents || simulated.rate != motion.rate) {
    return Error("ragdoll-value", "the motion that goes on has another skeleton or frame rate");
  }
  Clip clip = simulated;
  const int last = simulated.frame_count() - 1;
  if (last < 0 || last + 1 >= motion.frame_count()) return clip;
  const std::vector<Offset> offsets = offsets_at(simulated, motion, last, span);
  clip.resize(motion.frame_count());
  Local pose;
  for (int frame = last + 1; frame < motion.frame_count(); ++frame) {
    const double time = (frame - last) / motion.rate;
    if (time >= span) {
      std::ranges::copy(motion.frame_positions(frame), clip.frame_positions(frame).begin());
      std::ranges::copy(motion.frame_orientations(frame), clip.frame_orientations(frame).begin());
      continue;
    }
    pose = local_pose(motion, frame);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      pose[j].position += offsets[j].shift.at(time);
      pose[j].orientation = from_rotation_vector(offsets[j].turn.at(time)) * pose[j].orientation;
    }
    local_to_world(motion.skeleton.parents, pose, pose);
    clip.set_pose(frame, pose);
  }
  return clip;
}

}  // namespace krok::ragdoll
