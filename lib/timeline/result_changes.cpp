#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "core/text.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/sample.h"
#include "roles/roles.h"
#include "timeline/mix.h"
#include "timeline/result_keys_internal.h"

namespace krok::timeline {

namespace {

// How fast the hips and the feet go through the world, and how hard they are accelerated.

struct TrackedJoints {
  int hips = 0;
  std::vector<int> feet;  // ankles and balls; empty where no role tells
};

struct PaceNow {
  double value = 0;  // metres a second, or a second squared
  int joint = 0;
};

constexpr std::size_t kMaxMoments = 4000;
constexpr double kUsualPart = 0.99;
constexpr double kFaster = 1.5, kSlow = 0.3;  // metres per second
constexpr double kHarder = 2.5, kSoft = 10;   // metres per second squared

TrackedJoints tracked_joints(const RoleMap& roles) {
  TrackedJoints joints;
  joints.hips = carrying_joint(roles);
  for (const Role role : {Role::left_foot, Role::right_foot, Role::left_toes, Role::right_toes}) {
    const int joint = roles.joint(role);
    if (joint >= 0) joints.feet.push_back(joint);
  }
  return joints;
}

// By PaceOf, from three successive poses (joint_to_world) at `rate` poses per second; speeds are
// those from the second to the third.
std::array<PaceNow, kPaces> paces_of(const TrackedJoints& joints, std::span<const Transform> before,
                                     std::span<const Transform> now,
                                     std::span<const Transform> next, double rate) {
  std::array<PaceNow, kPaces> paces;
  const auto add = [&](PaceOf of, double value, int joint) {
    if (value > paces[of].value) paces[of] = {value, joint};
  };
  const auto look_at = [&](int joint, PaceOf speed, PaceOf acceleration) {
    const Vec3 step = next[at(joint)].position - now[at(joint)].position;
    const Vec3 step_before = now[at(joint)].position - before[at(joint)].position;
    add(speed, step.norm() * rate, joint);
    add(acceleration, (step - step_before).norm() * rate * rate, joint);
  };
  look_at(joints.hips, hips_speed, hips_acceleration);
  for (const int joint : joints.feet) look_at(joint, feet_speed, feet_acceleration);
  return paces;
}

// The 99th percentiles over a motion played at `speed`, seen at `rate` frames per second, by
// PaceOf.
std::array<double, kPaces> usual_paces(const TrackedJoints& joints, const Clip& clip, double speed,
                                       double rate, int jobs) {
  std::array<double, kPaces> usual = {};
  const double step = std::abs(speed) / rate;  // of the source's time
  const double steps = std::floor(clip.duration() / step + 1e-6);
  if (!(steps >= 2)) return usual;
  const double moments = std::min(steps - 1, static_cast<double>(kMaxMoments));
  std::vector<std::array<PaceNow, kPaces>> paces(static_cast<std::size_t>(moments));
  const double stride = std::floor((steps - 1) / moments);
  parallel_for(paces.size(), 64, jobs, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = clip.skeleton.names.size();
    std::array<std::vector<Transform>, 3> poses;
    for (auto& pose : poses) pose.resize(count);
    std::vector<Transform> scratch(3 * count);
    for (std::size_t i = begin; i < end; ++i) {
      for (int k = 0; k < 3; ++k) {
        sample(clip, (static_cast<double>(i) * stride + k) * step, poses[at(k)], scratch);
      }
      paces[i] = paces_of(joints, poses[0], poses[1], poses[2], rate);
    }
  });
  std::vector<double> values(paces.size());
  for (std::size_t of = 0; of < usual.size(); ++of) {
    std::ranges::transform(paces, values.begin(), [&](const auto& one) { return one[of].value; });
    const auto place =
        static_cast<std::ptrdiff_t>(kUsualPart * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + place, values.end());
    usual[of] = values[static_cast<std::size_t>(place)];
  }
  return usual;
}

constexpr std::size_t kMaxFrames = 4000;  // frames per motion sampled by usual_speed()
constexpr double kUsual = 0.99;
constexpr double kTravels = 0.5;  // metres per second

struct Angle {
  double angle = 0;
  int joint = 0;
};

Angle largest_angle(std::span<const Transform> a, std::span<const Transform> b) {
  Angle largest;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const double angle = angle_between(a[j].orientation, b[j].orientation);
    if (angle > largest.angle) largest = {angle, static_cast<int>(j)};
  }
  return largest;
}

// The 99th percentile over frames of the largest local angular velocity of a joint.
double usual_speed(const Clip& clip, int jobs) {
  const int frames = clip.frame_count();
  if (frames < 2) return 0;
  const auto steps = static_cast<std::size_t>(frames - 1);
  const std::size_t stride = (steps + kMaxFrames - 1) / kMaxFrames;
  std::vector<double> speeds((steps + stride - 1) / stride);
  parallel_for(speeds.size(), 64, jobs, [&](std::size_t begin, std::size_t end) {
    const std::size_t joints = clip.skeleton.names.size();
    std::vector<Transform> world(joints), before(joints), after(joints);
    for (std::size_t i = begin; i < end; ++i) {
      const int frame = static_cast<int>(i * stride);
      clip.get_pose(frame, world);
      world_to_local(clip.skeleton.parents, world, before);
      clip.get_pose(frame + 1, world);
      world_to_local(clip.skeleton.parents, world, after);
      // The root rotation, which turns the character, is included.
      speeds[i] = largest_angle(before, after).angle * clip.rate;
    }
  });
  const auto place = static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(speeds.size() - 1));
  std::nth_element(speeds.begin(), speeds.begin() + place, speeds.end());
  return speeds[static_cast<std::size_t>(place)];
}

class ChangeFinder {
 public:
  ChangeFinder(const Parts& parts, Diagnostics& warnings)
      : parts_(parts), warnings_(warnings), joints_(tracked_joints(parts.roles)) {}

  std::vector<ChangeFacts> find() {
    std::vector<ChangeFacts> changes;
    for (std::size_t i = 0; i < parts_.base.items().size(); ++i) {
      check_seams(i);
      check_steps(i);
      if (i > 0) changes.push_back(change(i));
    }
    for (std::size_t layer = 0; layer < parts_.layers.size(); ++layer) check_layer(layer);
    return changes;
  }

 private:
  // usual_speed() of the source, scaled by the item's speed.
  double usual(std::size_t item) { return usual(parts_.base.items()[item].range); }
  double usual(const PlayedRange& range) {
    const auto [found, is_new] = usual_.try_emplace(range.source, 0.0);
    if (is_new) {
      found->second =
          usual_speed(*parts_.sources[static_cast<std::size_t>(range.source)].clip, parts_.jobs);
    }
    return found->second * std::abs(range.speed);
  }

  std::array<double, kPaces> usual_paces_of(std::size_t item) {
    const PlayedRange& range = parts_.base.items()[item].range;
    const auto [found, is_new] = usual_paces_.try_emplace({range.source, std::abs(range.speed)});
    if (is_new) {
      found->second = usual_paces(joints_, *parts_.sources[at(range.source)].clip, range.speed,
                                  parts_.clip.rate, parts_.jobs);
    }
    return found->second;
  }

  std::vector<Transform> world_at(double time) const {
    std::vector<Transform> world(parts_.clip.skeleton.names.size());
    parts_.base.pose(time, world);
    return world;
  }
  std::vector<Transform> local_at(double time) const {
    const std::vector<Transform> world = world_at(time);
    std::vector<Transform> local(world.size());
    world_to_local(parts_.clip.skeleton.parents, world, local);
    return local;
  }

  // Takes up what is more than before.
  void look_at_paces(double time, int frame, std::array<Pace, kPaces>& paces) const {
    const double step = 1 / parts_.clip.rate;
    const auto here = paces_of(joints_, world_at(time - 2 * step), world_at(time - step),
                               world_at(time), parts_.clip.rate);
    for (std::size_t of = 0; of < kPaces; ++of) {
      if (here[of].value <= paces[of].most) continue;
      paces[of].most = here[of].value;
      paces[of].joint = here[of].joint;
      paces[of].frame = frame;
    }
  }

  // In the change into an item, from one frame to another.
  std::array<Pace, kPaces> paces_within(std::size_t item, int begin, int end) {
    std::array<Pace, kPaces> paces;
    for (const std::size_t side : {item - 1, item}) {
      const auto usual = usual_paces_of(side);
      for (std::size_t of = 0; of < kPaces; ++of) {
        paces[of].usual = std::max(paces[of].usual, usual[of]);
      }
    }
    // Two frames before the first are needed.
    for (int f = std::max(2, begin + 1); f <= end; ++f) {
      look_at_paces(f / parts_.clip.rate, f, paces);
    }
    return paces;
  }

  ChangeFacts change(std::size_t i) {
    const ScheduledItem& item = parts_.base.items()[i];
    const ScheduledItem& before = parts_.base.items()[i - 1];
    ChangeFacts facts;
    facts.item = static_cast<int>(i);
    facts.kind = parts_.timeline.base[i].change.kind;
    facts.begin = item.begin;
    facts.end = item.settled;
    facts.in_step = item.in_step;
    facts.on_feet = parts_.base.on_feet(i);
    const ActorPose from = parts_.base.player(i - 1).actor(before.play_time(item.begin));
    const ActorPose to = parts_.base.player(i).actor(item.play_time(item.start));
    const Angle bridged = largest_angle(from.local, to.local);
    facts.angle = bridged.angle;
    facts.angle_joint = bridged.joint;
    facts.usual = std::max(usual(i - 1), usual(i));
    const double rate = parts_.clip.rate;
    const int last = parts_.clip.frame_count() - 1;
    const int begin = std::clamp(static_cast<int>(std::floor(item.begin * rate)) - 1, 0, last);
    const int end = std::clamp(static_cast<int>(std::ceil(item.settled * rate)) + 1, 0, last);
    facts.paces = paces_within(i, begin, end);
    std::vector<Transform> pose = local_at(begin / rate);
    for (int f = begin + 1; f <= end; ++f) {
      std::vector<Transform> next = local_at(f / rate);
      const Angle turned = largest_angle(pose, next);
      if (turned.angle * rate > facts.fastest) {
        facts.fastest = turned.angle * rate;
        facts.fastest_joint = turned.joint;
        facts.fastest_frame = f;
      }
      pose = std::move(next);
    }
    return facts;
  }

  // Warns if a change cuts across steps: those of keytimes that do not match, or of motions that
  // both travel.
  void check_steps(std::size_t i) {
    const ScheduledItem& item = parts_.base.items()[i];
    const bool unknown = item.lacks_keys && travels(i - 1, item) && travels(i, item);
    if (!item.has_other_keys && !unknown) return;
    Diagnostic warning = make_warning(
        "timeline-clock",
        fmt::format(
            "{}: the change into it is not in step: {}", shown(parts_.timeline.base[i].name),
            unknown ? "both motions travel, and one has no keytimes"
                    : "its keytimes have other names or another order than those before it"),
        "set keytimes with krok-keys, or \"sync\": \"clock\" if it is wanted");
    warning.where = parts_.timeline.base[i].where;
    warnings_.push_back(std::move(warning));
  }

  // Whether an item's hips travel during a change.
  bool travels(std::size_t i, const ScheduledItem& change) const {
    const ScheduledItem& item = parts_.base.items()[i];
    const auto place = [&](double time) {
      return parts_.base.player(i).actor(item.play_time(time)).place;
    };
    const GroundFrame from = place(change.begin), to = place(change.settled);
    return std::hypot(to.x - from.x, to.z - from.z) >
           kTravels * std::max(1e-3, change.settled - change.begin);
  }

  // Warns if a layer turns joints faster than the motions do where an item begins or ends.
  void check_layer(std::size_t index) {
    const LayerPlayer& player = parts_.layers[index];
    const double rate = parts_.clip.rate;
    for (std::size_t i = 0; i < player.items().size(); ++i) {
      const LayerItem& item = parts_.timeline.layers[index].items[i];
      const LayerTimes& times = player.items()[i];
      const auto begin = static_cast<int>(std::ceil(times.start * rate - kTimeRounding));
      const auto end = static_cast<int>(std::floor(times.end * rate + kTimeRounding));
      const auto lasts = [&](const Fade& fade) {
        return static_cast<int>(std::ceil(fade.duration * rate));
      };
      check_edge(player, i, item, true, begin, begin + lasts(item.fade_in));
      check_edge(player, i, item, false, end + 1 - lasts(item.fade_out), end + 1);
    }
  }

  // From the frame before `first` to frame `last`.
  void check_edge(const LayerPlayer& player, std::size_t index, const LayerItem& item, bool begins,
                  int first, int last) {
    const LayerTimes& times = player.items()[index];
    double allowed = usual(times.range);
    for (std::size_t i = 0; i < parts_.base.items().size(); ++i) {
      const ScheduledItem& base = parts_.base.items()[i];
      if (base.begin <= times.end && base.end >= times.start) {
        allowed = std::max(allowed, usual(i));
      }
    }
    const std::size_t joints = parts_.clip.skeleton.names.size();
    std::vector<Transform> world(joints), before(joints), now(joints);
    double fastest = 0;
    std::size_t joint = 0;
    int frame = 0;
    const int from = std::max(first - 1, 0), to = std::min(last, parts_.clip.frame_count() - 1);
    for (int f = from; f <= to; ++f) {
      parts_.clip.get_pose(f, world);
      world_to_local(parts_.clip.skeleton.parents, world, now);
      for (std::size_t j = 0; j < joints && f > from; ++j) {
        if (player.touched()[j] == 0) continue;
        const double turn = angle_between(before[j].orientation, now[j].orientation);
        if (turn * parts_.clip.rate <= fastest) continue;
        fastest = turn * parts_.clip.rate;
        joint = j;
        frame = f;
      }
      std::swap(before, now);
    }
    // As in ChangeFacts::turns_too_fast().
    if (fastest <= 1.1 * allowed || allowed == 0) return;
    const Fade& fade = begins ? item.fade_in : item.fade_out;
    Diagnostic pop;
    pop.severity = Severity::warning;
    pop.code = "mix-pop";
    pop.joint = parts_.clip.skeleton.names[at(parts_.hips_root.original(static_cast<int>(joint)))];
    pop.frame = frame;
    pop.message = fmt::format(
        "{} of the layer rotates {} at {:.0f} degrees per second where it {} (frame {}); 99 % of "
        "the frames of the motions stay below {:.0f}",
        shown(item.name), pop.joint, fastest / kRadiansPerDegree, begins ? "begins" : "ends", frame,
        allowed / kRadiansPerDegree);
    pop.hint = fade.duration > 0
                   ? "use a longer fade, or the easing smooth"
                   : fmt::format("\"{}\" makes it smooth", begins ? "fade_in" : "fade_out");
    pop.where = item.where;
    warnings_.push_back(std::move(pop));
  }

  // Warns if a loop jumps from its end to its start.
  void check_seams(std::size_t i) {
    const ScheduledItem& item = parts_.base.items()[i];
    if (item.range.at(item.play_time(item.end)).round == 0) return;
    const ItemPlayer& player = parts_.base.player(i);
    PlayedRange once = item.range;
    once.rounds = 1;
    const ItemPlayer round(player.source(), once, parts_.base.carrier(), 0);
    const Angle jump = largest_angle(round.actor(0).local, round.actor(once.round).local);
    const double usual_turn = usual(i) / parts_.clip.rate;
    if (usual_turn == 0 || jump.angle <= usual_turn) {
      check_pace_of_seam(i);
      return;
    }
    Diagnostic seam;
    seam.severity = Severity::warning;
    seam.code = "timeline-seam";
    seam.joint = parts_.clip.skeleton.names[at(parts_.hips_root.original(jump.joint))];
    seam.message = fmt::format("{}: the loop has a seam: {} jumps by {:.1f} degrees",
                               shown(parts_.timeline.base[i].name), seam.joint,
                               jump.angle / kRadiansPerDegree);
    seam.hint = "use krok-edit --loop to make a seamless loop";
    seam.where = parts_.timeline.base[i].where;
    warnings_.push_back(std::move(seam));
  }

  // Warns if the hips or feet jump where the second round begins.
  void check_pace_of_seam(std::size_t i) {
    const ScheduledItem& item = parts_.base.items()[i];
    const double rate = parts_.clip.rate, seam = item.time_of(item.range.round);
    if (!(seam - 2 / rate >= item.settled) || seam + 2 / rate > item.end) return;
    const auto usual = usual_paces_of(i);
    std::array<Pace, kPaces> paces;
    for (std::size_t of = 0; of < kPaces; ++of) paces[of].usual = usual[of];
    for (int k = 0; k < 3; ++k) look_at_paces(seam + (k + 0.5) / rate, 0, paces);
    const auto worst = worst_pace(paces);
    if (!worst) return;
    const Pace& pace = paces[*worst];
    const bool speed = *worst == hips_speed || *worst == feet_speed;
    Diagnostic diagnostic;
    diagnostic.severity = Severity::warning;
    diagnostic.code = "timeline-seam";
    diagnostic.joint = parts_.clip.skeleton.names[at(parts_.hips_root.original(pace.joint))];
    diagnostic.message = fmt::format(
        "{}: the loop has a seam: {} {} {:.1f} {}; 99 % of the frames of the motion stay below "
        "{:.1f}",
        shown(parts_.timeline.base[i].name), diagnostic.joint,
        speed ? "moves at" : "is accelerated by", pace.most, speed ? "m/s" : "m/s²", pace.usual);
    diagnostic.hint = "use krok-edit --loop to make a seamless loop";
    diagnostic.where = parts_.timeline.base[i].where;
    warnings_.push_back(std::move(diagnostic));
  }

  const Parts& parts_;
  Diagnostics& warnings_;
  TrackedJoints joints_;
  std::map<int, double> usual_;                                               // by source
  std::map<std::pair<int, double>, std::array<double, kPaces>> usual_paces_;  // by source and speed
};

}  // namespace

std::vector<ChangeFacts> result_changes(const Parts& parts, Diagnostics& warnings) {
  return ChangeFinder(parts, warnings).find();
}

std::optional<PaceOf> worst_pace(const std::array<Pace, kPaces>& paces) {
  std::optional<PaceOf> worst;
  double furthest = 1;
  for (const PaceOf of : {hips_speed, feet_speed, hips_acceleration, feet_acceleration}) {
    const bool speed = of == hips_speed || of == feet_speed;
    const double allowed = speed ? std::max(kFaster * paces[of].usual, kSlow)
                                 : std::max(kHarder * paces[of].usual, kSoft);
    if (paces[of].most / allowed <= furthest) continue;
    furthest = paces[of].most / allowed;
    worst = of;
  }
  return worst;
}

}  // namespace krok::timeline
