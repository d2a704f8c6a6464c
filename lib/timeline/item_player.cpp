#include "timeline/item_player.h"

#include <algorithm>
#include <cmath>

#include "motion/sample.h"
#include "scene/frame_moment.h"

namespace krok::timeline {

namespace {

constexpr double kContactFade = 0.1;  // seconds

void sample_source(const Clip& clip, double time, std::span<Transform> joint_to_world) {
  // Per thread, to avoid an allocation per frame.
  thread_local std::vector<Transform> scratch;
  scratch.resize(3 * joint_to_world.size());
  sample(clip, time, joint_to_world, scratch);
}

bool is_nowhere_else(const GroundFrame& place) {
  return place.x == 0 && place.z == 0 && place.heading == 0;
}

}  // namespace

ItemPlayer::ItemPlayer(const Source& source, const PlayedRange& range, int carrier, double longest)
    : source_(&source), range_(range), carrier_(carrier) {
  const int last = range.at(longest).round;
  if (last == 0) return;
  const Clip& clip = *source.clip;
  std::vector<Transform> pose(clip.skeleton.names.size());
  const auto place_at = [&](double time) {
    sample_source(clip, time, pose);
    return ground_frame(clip.skeleton, carrier, pose[static_cast<std::size_t>(carrier)]);
  };
  const bool forward = range.speed > 0;
  const GroundFrame step = combined(place_at(forward ? range.to : range.from),
                                    inverse(place_at(forward ? range.from : range.to)));
  steps_.push_back(step);
  while (last >> steps_.size() != 0) steps_.push_back(combined(steps_.back(), steps_.back()));
}

void ItemPlayer::put(double play_time, const GroundFrame& place) {
  motion_to_world_ = {};
  motion_to_world_ = combined(place, inverse(actor(play_time).place));
}

GroundFrame ItemPlayer::round_place(int round) const {
  GroundFrame place = motion_to_world_;
  for (std::size_t bit = 0; bit < steps_.size(); ++bit) {
    if ((round >> bit & 1) != 0) place = combined(place, steps_[bit]);
  }
  return place;
}

void ItemPlayer::pose(double play_time, std::span<Transform> joint_to_world) const {
  const auto moment = range_.at(play_time);
  sample_source(*source_->clip, moment.time, joint_to_world);
  const GroundFrame place = round_place(moment.round);
  if (is_nowhere_else(place)) return;
  const Transform motion_to_world = place.to_world();
  for (Transform& joint : joint_to_world) joint = motion_to_world * joint;
}

ActorPose ItemPlayer::actor(double play_time) const {
  const Skeleton& skeleton = source_->clip->skeleton;
  std::vector<Transform> joint_to_world(skeleton.names.size());
  pose(play_time, joint_to_world);
  return actor_pose(skeleton, carrier_, joint_to_world);
}

int ItemPlayer::untouched_frame(double play_time) const {
  const auto moment = range_.at(play_time);
  if (!is_nowhere_else(round_place(moment.round))) return -1;
  const Clip& clip = *source_->clip;
  const FrameMoment frame = frame_moment(moment.time, clip.rate, clip.frame_count());
  return frame.fraction == 0 ? frame.before : -1;
}

bool ItemPlayer::stands(int joint, double play_time) const {
  if (source_->keys == nullptr) return false;
  const double time = range_.at(play_time).time;
  return std::ranges::any_of(source_->keys->contacts, [&](const Contact& contact) {
    return contact.joint == joint && contact.start <= time && time <= contact.end;
  });
}

double ItemPlayer::contact_weight(int joint, double play_time) const {
  if (source_->keys == nullptr) return 0;
  const double time = range_.at(play_time).time, last = source_->clip->duration();
  double most = 0;
  for (const Contact& contact : source_->keys->contacts) {
    if (contact.joint != joint || time < contact.start || time > contact.end) continue;
    const double fade = std::min(kContactFade, 0.5 * (contact.end - contact.start));
    const double begun = contact.start <= kContactFade ? 1 : (time - contact.start) / fade;
    const double rest = contact.end >= last - kContactFade ? 1 : (contact.end - time) / fade;
    const double part = std::clamp(std::min(begun, rest), 0.0, 1.0);
    most = std::max(most, part * part * (3 - 2 * part));
  }
  return most;
}

}  // namespace krok::timeline
