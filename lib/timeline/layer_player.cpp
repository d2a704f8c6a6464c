#include "timeline/layer_player.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "math/quaternion.h"
#include "motion/joint_selection.h"
#include "motion/sample.h"

namespace krok::timeline {

namespace {

Status check_rule(const MaskRule& rule) {
  if (!(rule.weight >= 0 && rule.weight <= 1)) {
    return Error("timeline-mask", "the weight of a mask rule is not between 0 and 1");
  }
  if (rule.soft < 0) return Error("timeline-mask", "the soft edge of a mask rule is negative");
  if (rule.joints.empty() == rule.below.empty()) {
    return Error("timeline-mask", "a mask rule needs either \"joints\" or \"below\"");
  }
  return {};
}

}  // namespace

Result<std::vector<double>> mask_weights(const Skeleton& skeleton,
                                         std::span<const MaskRule> rules) {
  std::vector<double> weights(skeleton.names.size(), rules.empty() ? 1 : 0);
  for (const MaskRule& rule : rules) {
    const auto located = [&](Error error) {
      error.code = "timeline-mask";
      error.where = rule.where;
      return error;
    };
    if (Status status = check_rule(rule); !status) return located(status.error());
    JointSelection selection;
    if (rule.below.empty()) {
      selection.patterns = {rule.joints};
    } else {
      selection.below = {rule.below};
    }
    const auto selected = select_joints(skeleton, selection);
    if (!selected) return located(selected.error());
    const int top = rule.below.empty() ? -1 : skeleton.find(rule.below);
    std::vector<int> depth(weights.size(), 0);
    for (std::size_t j = 0; j < weights.size(); ++j) {
      if (!(*selected)[j]) continue;
      if (top >= 0 && static_cast<int>(j) != top) {
        depth[j] = depth[static_cast<std::size_t>(skeleton.parents[j])] + 1;
      }
      const double rise = top < 0 ? 1.0 : std::min(1.0, (depth[j] + 1.0) / (rule.soft + 1.0));
      weights[j] = rule.weight * rise;
    }
  }
  return weights;
}

namespace {

Status check_weight(const LayerItem& item, LayerMode mode) {
  const blend::WeightCurve& curve = item.weight;
  if (curve.weights.empty() || curve.weights.size() != curve.generic.size()) {
    return Error("timeline-weight", "the weight curve has no points");
  }
  for (std::size_t i = 0; i < curve.weights.size(); ++i) {
    if (!std::isfinite(curve.weights[i]) || !std::isfinite(curve.generic[i]) ||
        (i > 0 && !(curve.generic[i] > curve.generic[i - 1]))) {
      return Error("timeline-weight", "the times of the weight curve are not increasing");
    }
    if (mode != LayerMode::modifier && !(curve.weights[i] >= 0 && curve.weights[i] <= 1)) {
      return Error("timeline-weight",
                   fmt::format("the weight {} is not between 0 and 1", readable(curve.weights[i])),
                   "layers of mode \"modifier\" accept any weight");
    }
  }
  return {};
}

Result<LayerTimes> times_of(const LayerItem& item, std::span<const Source> sources, double rate,
                            double end) {
  auto range = resolve(item.play, sources);
  if (!range) return range.error();
  LayerTimes times;
  times.range = *range;
  times.start = item.at.seconds(rate);
  if (!(times.start >= 0) || times.start > end + kTimeRounding) {
    return Error("timeline-time",
                 fmt::format("starts at {} s, outside the base's range of 0 to {} s",
                             readable(times.start), readable(end)));
  }
  if (item.play.until && times.range.loops_if_ended) times.range.rounds = HUGE_VAL;
  // An endless layer ends with the base.
  times.end = std::min(times.start + times.range.duration(), end);
  if (item.play.until) {
    const double until = item.play.until->seconds(rate);
    if (!(until >= times.start - kTimeRounding) ||
        until > times.start + times.range.duration() + kTimeRounding) {
      return Error(
          "timeline-time",
          fmt::format("ends at {} s, but can only play from {} to {} s", readable(until),
                      readable(times.start), readable(times.start + times.range.duration())),
          "set \"loop\": true to repeat it until then");
    }
    times.end = std::min(until, times.end);
  }
  if (times.range.round > 0 && (times.end - times.start) / times.range.round > kMaxRounds) {
    return Error("timeline-limit", fmt::format("repeats more than {} times", grouped(kMaxRounds)));
  }
  for (const Fade* fade : {&item.fade_in, &item.fade_out}) {
    if (fade->duration >= 0 && fade->duration <= times.end - times.start + kTimeRounding) continue;
    return Error("timeline-time",
                 fmt::format("a fade of {} s is negative or longer than the item's {} s",
                             readable(fade->duration), readable(times.end - times.start)));
  }
  return times;
}

// The reference pose of an additive layer.
Result<ActorPose> reference_of(const Layer& layer, const ItemPlayer& player, int carrier) {
  const Clip& clip = *player.source().clip;
  if (layer.reference_pose) return actor_pose(clip.skeleton, carrier, clip.skeleton.reference);
  if (!layer.reference) return player.actor(0);
  const double time = layer.reference->seconds(clip.rate);
  if (!(time >= 0) || time > clip.duration() + kTimeRounding) {
    Error error("timeline-time",
                fmt::format("the reference time {} s is outside 0 to {} s of {}", readable(time),
                            readable(clip.duration()), shown(player.source().name)));
    error.where = layer.where;
    return error;
  }
  std::vector<Transform> pose(clip.skeleton.names.size()), scratch(3 * pose.size());
  sample(clip, time, pose, scratch);
  return actor_pose(clip.skeleton, carrier, pose);
}

}  // namespace

Result<LayerPlayer> LayerPlayer::create(const Layer& layer, std::span<const Source> sources,
                                        const HipsRoot& hips_root, int carrier, double rate,
                                        double end) {
  LayerPlayer player;
  player.layer_ = &layer;
  player.skeleton_ = &sources.front().clip->skeleton;
  auto mask = mask_weights(*player.skeleton_, layer.mask);
  if (!mask) return mask.error();
  player.mask_ = hips_root.rooted(std::span(*mask).first(hips_root.below().size()));
  for (std::size_t j = 0; j < player.mask_.size(); ++j) {
    const int parent = player.skeleton_->parents[j];
    const bool above = parent >= 0 && player.touched_[static_cast<std::size_t>(parent)] != 0;
    player.touched_.push_back(above || player.mask_[j] > 0 ? 1 : 0);
  }
  for (const LayerItem& item : layer.items) {
    const auto located = [&](Error error) {
      error.where = item.where;
      error.message = fmt::format("{}: {}", shown(item.name), error.message);
      return error;
    };
    if (Status status = check_weight(item, layer.mode); !status) return located(status.error());
    const auto times = times_of(item, sources, rate, end);
    if (!times) return located(times.error());
    player.items_.push_back(*times);
    player.players_.emplace_back(sources[static_cast<std::size_t>(times->range.source)],
                                 times->range, carrier, times->end - times->start);
    if (layer.mode == LayerMode::override) continue;
    auto reference = reference_of(layer, player.players_.back(), carrier);
    if (!reference) return reference.error();
    player.references_.push_back(std::move(*reference));
  }
  return player;
}

double LayerPlayer::weight(std::size_t item, double time) const {
  const LayerTimes& times = items_[item];
  const LayerItem& entry = layer_->items[item];
  if (!(time >= times.start) || time > times.end + kTimeRounding) return 0;
  const auto faded = [](const Fade& fade, double since) {
    return fade.duration > 0 ? fade.easing.at(since / fade.duration) : 1.0;
  };
  return entry.weight.at(time - times.start) * faded(entry.fade_in, time - times.start) *
         faded(entry.fade_out, times.end - time);
}

bool LayerPlayer::is_seen(double time) const {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (weight(i, time) != 0) return true;
  }
  return false;
}

void LayerPlayer::apply(double time, ActorPose& pose) const {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const double share = weight(i, time);
    if (share == 0) continue;
    const ActorPose layer = players_[i].actor(time - items_[i].start);
    if (layer_->mode != LayerMode::override) {
      add(layer, references_[i], share, pose);
    } else if (layer_->space == Space::model) {
      override_in_model(layer, share, pose);
    } else {
      override_pose(layer, share, pose);
    }
  }
}

void LayerPlayer::override_pose(const ActorPose& layer, double weight, ActorPose& pose) const {
  for (std::size_t j = 0; j < mask_.size(); ++j) {
    const double share = weight * mask_[j];
    if (share == 0) continue;
    Transform& joint = pose.local[j];
    joint.position += share * (layer.local[j].position - joint.position);
    joint.orientation = slerp(joint.orientation, layer.local[j].orientation, share);
  }
}

void LayerPlayer::override_in_model(const ActorPose& layer, double weight, ActorPose& pose) const {
  // Joint rotations relative to the ground frame.
  std::vector<Quat> below(mask_.size()), above(mask_.size());
  for (std::size_t j = 0; j < mask_.size(); ++j) {
    const int parent = skeleton_->parents[j];
    const auto p = static_cast<std::size_t>(std::max(parent, 0));
    const Quat turned = parent < 0 ? Quat::Identity() : below[p];
    above[j] = (parent < 0 ? Quat::Identity() : above[p]) * layer.local[j].orientation;
    Transform& joint = pose.local[j];
    const double share = weight * mask_[j];
    if (share != 0) {
      joint.position += share * (layer.local[j].position - joint.position);
      joint.orientation = slerp(joint.orientation, turned.conjugate() * above[j], share);
    }
    below[j] = turned * joint.orientation;
  }
}

void LayerPlayer::add(const ActorPose& layer, const ActorPose& reference, double weight,
                      ActorPose& pose) const {
  for (std::size_t j = 0; j < mask_.size(); ++j) {
    const double share = weight * mask_[j];
    if (share == 0) continue;
    const Quat turn = layer.local[j].orientation * reference.local[j].orientation.conjugate();
    Transform& joint = pose.local[j];
    joint.position += share * (layer.local[j].position - reference.local[j].position);
    joint.orientation = from_rotation_vector(share * rotation_vector(turn)) * joint.orientation;
  }
}

}  // namespace krok::timeline
