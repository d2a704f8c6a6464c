#include "timeline/base_motion.h"

#include <algorithm>

#include "math/quaternion.h"
#include "motion/sample.h"
#include "scene/clip.h"

namespace krok::timeline {

ActorPose actor_pose(const Skeleton& skeleton, int carrier,
                     std::span<const Transform> joint_to_world) {
  ActorPose pose;
  pose.place = ground_frame(skeleton, carrier, joint_to_world[static_cast<std::size_t>(carrier)]);
  pose.local.resize(joint_to_world.size());
  world_to_local(skeleton.parents, joint_to_world, pose.local);
  pose.local[0] = pose.place.to_world().inverse() * pose.local[0];
  return pose;
}

void to_world(const Skeleton& skeleton, const ActorPose& pose,
              std::span<Transform> joint_to_world) {
  std::copy(pose.local.begin(), pose.local.end(), joint_to_world.begin());
  joint_to_world[0] = pose.place.to_world() * pose.local[0];
  local_to_world(skeleton.parents, joint_to_world, joint_to_world);
}

GroundFrame combined(const GroundFrame& first, const GroundFrame& second) {
  const Vec3 there = first.to_world() * Vec3(second.x, 0, second.z);
  return {there.x(), there.z(), first.heading + second.heading};
}

GroundFrame inverse(const GroundFrame& place) {
  const Vec3 back = axis_rotation(Axis::y, -place.heading) * Vec3(-place.x, 0, -place.z);
  return {back.x(), back.z(), -place.heading};
}

Vec3 as_vector(const GroundFrame& place) {
  return {place.x, place.z, place.heading};
}

Vec3 difference(const GroundFrame& from, const GroundFrame& to) {
  return {to.x - from.x, to.z - from.z, wrapped(to.heading - from.heading)};
}

GroundFrame moved(const GroundFrame& place, const Vec3& by) {
  return {place.x + by.x(), place.z + by.y(), place.heading + by.z()};
}

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

BaseMotion::BaseMotion(const Timeline& timeline, std::span<const Source> sources,
                       const RoleMap& roles, std::vector<ScheduledItem> items, double rate)
    : carrier_(carrying_joint(roles)), items_(std::move(items)) {
  const auto source_of = [&](std::size_t i) -> const Source& {
    return sources[static_cast<std::size_t>(items_[i].range.source)];
  };
  players_.reserve(items_.size());  // transitions keep references to them
  skeleton_ = &source_of(0).clip->skeleton;
  transitions_.resize(items_.size());
  on_feet_.resize(items_.size(), 0);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    players_.emplace_back(source_of(i), items_[i].range, carrier_,
                          items_[i].play_time(items_[i].end));
    const BaseItem& entry = timeline.base[i];
    if (i == 0) {
      if (entry.place) players_[0].put(0, *entry.place);
      continue;
    }
    bool on_feet = false;
    transitions_[i] = make_transition(
        {players_[i - 1], players_[i], items_[i - 1], items_[i], entry.change, entry.place, rate},
        on_feet);
    on_feet_[i] = on_feet ? 1 : 0;
  }
}

std::size_t BaseMotion::item_at(double time) const {
  const auto after = std::ranges::upper_bound(items_, time, {}, &ScheduledItem::begin);
  return after == items_.begin() ? 0 : static_cast<std::size_t>(after - items_.begin()) - 1;
}

void BaseMotion::pose(double time, std::span<Transform> joint_to_world) const {
  const std::size_t i = item_at(time);
  if (transitions_[i] != nullptr && time < items_[i].settled) {
    to_world(*skeleton_, transitions_[i]->at(time), joint_to_world);
    return;
  }
  players_[i].pose(items_[i].play_time(time), joint_to_world);
}

BaseMotion::Untouched BaseMotion::untouched(double time) const {
  const std::size_t i = item_at(time);
  if (transitions_[i] != nullptr && time < items_[i].settled) return {};
  const int frame = players_[i].untouched_frame(items_[i].play_time(time));
  if (frame < 0) return {};
  return {players_[i].source().clip, frame};
}

}  // namespace krok::timeline
