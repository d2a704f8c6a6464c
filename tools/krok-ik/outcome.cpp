#include "tools/krok-ik/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "ik/limits.h"
#include "ik/whole_body.h"
#include "scene/frame_source.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli::ik {

namespace {

// Metres; who misses by more has meant another place, or another unit.
constexpr double kFarMissed = 1;

std::string_view kind_name(krok::ik::Goal::Kind kind) {
  switch (kind) {
    case krok::ik::Goal::Kind::position:
      return "position";
    case krok::ik::Goal::Kind::orientation:
      return "orientation";
    case krok::ik::Goal::Kind::pose:
      return "pose";
    case krok::ik::Goal::Kind::look_at:
      return "look-at";
    case krok::ik::Goal::Kind::pole:
      return "pole";
    case krok::ik::Goal::Kind::balance:
      break;
  }
  return "balance";
}

struct Summary {
  int reached = 0, counted = 0;                // frames
  const krok::ik::GoalFrame* worst = nullptr;  // missed by the most; nullptr if all are reached
  double distance = 0, angle = 0;              // largest
};

// Of the frames in which the goal has its full strength: one that fades in is reached without being
// where it was asked for. A goal that fades all the time is judged in all its frames.
Summary summary_of(const std::vector<krok::ik::GoalFrame>& frames) {
  Summary summary;
  const auto is_full = [](const krok::ik::GoalFrame& f) { return f.strength >= 1; };
  const bool any_full = std::any_of(frames.begin(), frames.end(), is_full);
  const auto miss = [](const krok::ik::GoalFrame& f) {
    return f.residual.distance + f.residual.angle;
  };
  for (const krok::ik::GoalFrame& frame : frames) {
    if (any_full && !is_full(frame)) continue;
    ++summary.counted;
    summary.distance = std::max(summary.distance, frame.residual.distance);
    summary.angle = std::max(summary.angle, frame.residual.angle);
    if (frame.residual.reached) {
      ++summary.reached;
    } else if (summary.worst == nullptr || miss(frame) > miss(*summary.worst)) {
      summary.worst = &frame;
    }
  }
  return summary;
}

std::string miss_text(double distance, double angle) {
  std::string text;
  if (distance > 0) text = readable(distance * 1000, 3) + " mm";
  if (angle > 0) {
    text += (text.empty() ? "" : " and ") + readable(angle / kRadiansPerDegree, 3) + " deg";
  }
  return text.empty() ? "nothing" : text;
}

std::string holder_text(const Outcome& outcome, const krok::ik::GoalFrame& frame) {
  const int joint = frame.residual.held_by;
  return joint < 0 ? std::string("it is out of reach")
                   : fmt::format("held back by the limits of '{}'",
                                 shown(outcome.input.skeleton.names[at(joint)]));
}

// Where the motion has the goal's joint.
std::string place_text(const Outcome& outcome, std::size_t goal, int frame, bool very_far) {
  const int joint = outcome.goals[goal].goal.joint;
  if (joint < 0) return {};
  const auto clip = load(part_of(outcome.input, frame, 1), 1);
  if (!clip) return {};
  const Vec3f place = clip->positions[at(joint)];
  return fmt::format(
      "'{}' is at {}m,{}m,{}m there; {}", shown(outcome.input.skeleton.names[at(joint)]),
      readable(place.x(), 3), readable(place.y(), 3), readable(place.z(), 3),
      very_far ? "goals are in metres, or with \"length_unit\": \"cm\" in centimetres"
               : "krok-edit --at-origin brings a motion to the origin");
}

Json joint_name(const Outcome& outcome, int joint) {
  return joint < 0 ? Json() : Json(outcome.input.skeleton.names[at(joint)]);
}

std::size_t count_of(const krok::ik::Limits& limits, krok::ik::JointLimit::Kind kind) {
  return static_cast<std::size_t>(
      std::count_if(limits.begin(), limits.end(),
                    [kind](const krok::ik::JointLimit& limit) { return limit.kind == kind; }));
}

}  // namespace

std::string summary(const Outcome& outcome) {
  int reached = 0, total = 0;
  for (const auto& frames : outcome.motion.goals) {
    const Summary goal = summary_of(frames);
    total += goal.counted;
    reached += goal.reached;
  }
  return fmt::format("{} in {} of {}, reached in {} of {} at full strength",
                     counted(outcome.goals.size(), "goal"), outcome.motion.changed_frames,
                     counted(outcome.input.frame_count, "frame"), reached, total);
}

std::string table(const Outcome& outcome) {
  std::string text;
  for (std::size_t g = 0; g < outcome.goals.size(); ++g) {
    const auto& frames = outcome.motion.goals[g];
    const Summary summary = summary_of(frames);
    text += fmt::format("  {} ({}): reached in {} of {}, off by {} at most\n",
                        shown(outcome.goals[g].name), kind_name(outcome.goals[g].goal.kind),
                        summary.reached, counted(summary.counted, "frame"),
                        miss_text(summary.distance, summary.angle));
  }
  return text;
}

Diagnostics missed_goals(const Outcome& outcome) {
  Diagnostics list;
  for (std::size_t g = 0; g < outcome.goals.size(); ++g) {
    const auto& frames = outcome.motion.goals[g];
    const Summary summary = summary_of(frames);
    Diagnostic warning;
    warning.severity = Severity::warning;
    if (frames.empty()) {
      warning.code = "ik-never";
      warning.message = fmt::format("goal '{}' is active in no frame of the motion",
                                    shown(outcome.goals[g].name));
      warning.hint = fmt::format("the motion lasts {} s", readable(outcome.input.duration(), 4));
      const auto& goal = outcome.goals[g];
      const double from = goal.from.value_or(goal.keys.empty() ? 0 : goal.keys.front().time);
      const std::string frame = frame_hint(ClipTime{.value = from}, outcome.input.frame_count);
      if (from > outcome.input.duration() && !frame.empty()) warning.hint += "; " + frame;
      list.push_back(std::move(warning));
      continue;
    }
    if (summary.worst == nullptr) continue;
    const krok::ik::GoalFrame& worst = *summary.worst;
    warning.code = "ik-missed";
    warning.message = fmt::format("goal '{}' is missed in {} of {}, by up to {} in frame {}: {}",
                                  shown(outcome.goals[g].name), summary.counted - summary.reached,
                                  counted(summary.counted, "frame"),
                                  miss_text(worst.residual.distance, worst.residual.angle),
                                  worst.frame, holder_text(outcome, worst));
    if (worst.residual.distance > kFarMissed) {
      warning.hint = place_text(outcome, g, worst.frame, worst.residual.distance > 20 * kFarMissed);
    }
    warning.frame = worst.frame;
    if (worst.residual.held_by >= 0) {
      warning.joint = outcome.input.skeleton.names[at(worst.residual.held_by)];
    }
    list.push_back(std::move(warning));
  }
  return list;
}

Diagnostics moved_feet(const Outcome& outcome, std::span<const krok::ik::HeldFoot> legs) {
  constexpr double kMoved = 0.01;  // metres
  const Skeleton& skeleton = outcome.input.skeleton;
  krok::ik::GoalMotion::Shift largest{kMoved, -1};
  int joint = -1;
  for (const krok::ik::HeldFoot& leg : legs) {
    const int foot = leg.foot;
    const krok::ik::GoalMotion::Shift& shift = outcome.motion.shifts[at(foot)];
    if (shift.distance <= largest.distance) continue;
    largest = shift;
    joint = foot;
  }
  if (joint < 0) return {};
  Diagnostic warning = make_warning(
      "ik-feet",
      fmt::format("goals move {} by up to {} mm, in frame {}", skeleton.names[at(joint)],
                  readable(1000 * largest.distance, 3), largest.frame),
      "legs do not reach from where the feet stay; goals for the feet move them, too (--goals)");
  warning.frame = largest.frame;
  return {std::move(warning)};
}

Diagnostics beyond_ranges(const Outcome& outcome) {
  constexpr double kFar = 30 * kRadiansPerDegree;
  const auto& excesses = outcome.motion.excesses;
  const auto worst = std::ranges::max_element(excesses, {}, &krok::ik::GoalMotion::Excess::angle);
  if (worst == excesses.end() || worst->angle < kFar) return {};
  Diagnostic warning =
      make_warning("ik-range",
                   fmt::format("goals bring {} {} deg beyond the range of people, in frame {}",
                               shown(outcome.input.skeleton.names[at(worst - excesses.begin())]),
                               readable(worst->angle / kRadiansPerDegree, 3), worst->frame),
                   "--limits auto keeps joints within published ranges");
  warning.frame = worst->frame;
  return {std::move(warning)};
}

Diagnostics moved_body(const Outcome& outcome) {
  constexpr double kMoved = 0.01;  // metres
  const Skeleton& skeleton = outcome.input.skeleton;
  const std::vector<std::uint8_t> sought = krok::ik::sought_by(outcome.goals, skeleton);
  std::size_t moved = 0, of = 0, farthest = 0;
  for (std::size_t j = 0; j < sought.size(); ++j) {
    if (sought[j] != 0) continue;
    ++of;
    const double distance = outcome.motion.shifts[j].distance;
    moved += distance > kMoved ? 1 : 0;
    if (distance >= outcome.motion.shifts[farthest].distance || sought[farthest] != 0) farthest = j;
  }
  if (moved == 0 || 2 * moved < of) return {};
  const krok::ik::GoalMotion::Shift& largest = outcome.motion.shifts[farthest];
  Diagnostic warning = make_warning(
      "ik-no-feet",
      fmt::format("no feet were found, so that nothing stays on the ground: goals take {} of {} "
                  "along, {} by up to {} mm in frame {}",
                  moved, counted(skeleton.names.size(), "joint"), shown(skeleton.names[farthest]),
                  readable(1000 * largest.distance, 3), largest.frame),
      "--map assigns the roles of legs, goals of kind pose hold what must stay (--goals), --depth "
      "limits the joints that move");
  warning.frame = largest.frame;
  return {std::move(warning)};
}

Json to_json(const Outcome& outcome, bool with_frames) {
  Json json;
  json["frames"] = outcome.input.frame_count;
  json["changed_frames"] = outcome.motion.changed_frames;
  json["largest_turn"] = {
      {"angle", to_degrees(outcome.motion.largest_turn)},
      {"joint", joint_name(outcome, outcome.motion.turning_joint)},
      {"frame", outcome.motion.turning_frame < 0 ? Json() : Json(outcome.motion.turning_frame)},
      {"input_angle", to_degrees(outcome.motion.input_turn)}};
  json["goals"] = Json::array();
  for (std::size_t g = 0; g < outcome.goals.size(); ++g) {
    const krok::ik::KeyedGoal& goal = outcome.goals[g];
    const auto& frames = outcome.motion.goals[g];
    const Summary summary = summary_of(frames);
    Json entry;
    entry["name"] = goal.name;
    entry["kind"] = kind_name(goal.goal.kind);
    const bool balance = goal.goal.kind == krok::ik::Goal::Kind::balance;
    entry["joint"] = joint_name(outcome, balance ? -1 : goal.goal.joint);
    entry["active_frames"] = frames.size();
    entry["full_strength_frames"] = summary.counted;
    entry["reached_frames"] = summary.reached;
    entry["largest_distance"] = summary.distance;
    entry["largest_angle"] = to_degrees(summary.angle);
    entry["worst_frame"] = summary.worst != nullptr ? Json(summary.worst->frame) : Json();
    entry["held_by"] =
        summary.worst != nullptr ? joint_name(outcome, summary.worst->residual.held_by) : Json();
    entry["frames"] = Json::array();
    for (const krok::ik::GoalFrame& frame : frames) {
      if (!with_frames) break;
      entry["frames"].push_back({{"frame", frame.frame},
                                 {"strength", frame.strength},
                                 {"distance", frame.residual.distance},
                                 {"angle", to_degrees(frame.residual.angle)},
                                 {"reached", frame.residual.reached},
                                 {"held_by", joint_name(outcome, frame.residual.held_by)}});
    }
    json["goals"].push_back(std::move(entry));
  }
  json["limits"] = limits_json(outcome.limits, outcome.input.skeleton);
  json["limits"]["largest_excess"] = to_degrees(outcome.motion.largest_excess);
  return json;
}

std::string limits_summary(const krok::ik::Limits& limits) {
  return fmt::format("limits of {}: {} with a cone, {} with a hinge, {} locked",
                     counted(limits.size(), "joint"),
                     count_of(limits, krok::ik::JointLimit::Kind::cone),
                     count_of(limits, krok::ik::JointLimit::Kind::hinge),
                     count_of(limits, krok::ik::JointLimit::Kind::locked));
}

Json limits_json(const krok::ik::Limits& limits, const Skeleton& skeleton) {
  Json json;
  json["joints"] = skeleton.joint_count();
  json["cones"] = count_of(limits, krok::ik::JointLimit::Kind::cone);
  json["hinges"] = count_of(limits, krok::ik::JointLimit::Kind::hinge);
  json["locked"] = count_of(limits, krok::ik::JointLimit::Kind::locked);
  return json;
}

namespace {

using krok::ik::Goal;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();  // breaks a line

bool has_distance(Goal::Kind kind) {
  return kind == Goal::Kind::position || kind == Goal::Kind::pose || kind == Goal::Kind::balance;
}
bool has_angle(Goal::Kind kind) {
  return kind == Goal::Kind::orientation || kind == Goal::Kind::pose ||
         kind == Goal::Kind::look_at || kind == Goal::Kind::pole;
}

class ChartMaker {
 public:
  ChartMaker(const Outcome& outcome, const Clip& given) : outcome_(outcome), given_(given) {
    for (int f = 0; f < given.frame_count(); ++f) times_.push_back(f / given.rate);
  }

  // What is less than this is a line at 0, not a mountain range of rounding errors.
  static constexpr double kFewMillimetres = 1, kFewDegrees = 0.1;

  // One line a goal; it breaks where the goal is not active.
  draw::Panel residuals(bool angles) const {
    draw::Panel panel =
        over_time(angles ? "Angle by which goals are missed" : "Distance by which goals are missed",
                  angles ? "angle" : "distance", angles ? "\u00B0" : "mm");
    for (std::size_t g = 0; g < outcome_.goals.size(); ++g) {
      const Goal::Kind kind = outcome_.goals[g].goal.kind;
      if (!(angles ? has_angle(kind) : has_distance(kind))) continue;
      std::vector<double> values(times_.size(), kGap);
      for (const krok::ik::GoalFrame& frame : outcome_.motion.goals[g]) {
        values[at(frame.frame)] =
            angles ? frame.residual.angle / kRadiansPerDegree : frame.residual.distance * 1000;
      }
      // The same colour for the same goal in all panels.
      add(outcome_.goals[g].name, std::move(values), static_cast<int>(g), panel);
    }
    widen(angles ? kFewDegrees : kFewMillimetres, panel);
    return panel;
  }

  // A line at a height of its own for each joint, over the times in which its limits hold a goal
  // back.
  draw::Panel holders() const {
    draw::Panel panel = over_time("Joints whose limits hold a goal back", "joint", "");
    std::map<int, std::vector<double>> held;  // by joint
    for (const auto& frames : outcome_.motion.goals) {
      for (const krok::ik::GoalFrame& frame : frames) {
        if (frame.residual.held_by < 0) continue;
        held.try_emplace(frame.residual.held_by, times_.size(), kGap)
            .first->second[at(frame.frame)] = 0;
      }
    }
    int place = 0;
    for (auto& [joint, values] : held) {
      ++place;
      for (double& value : values) value += place;
      add(outcome_.input.skeleton.names[at(joint)], std::move(values), place - 1, panel);
    }
    panel.y.low = 0;
    panel.y.high = place + 1;
    return panel;
  }

  draw::Panel beyond_limits() const {
    draw::Panel panel =
        over_time("Rotation beyond limits, largest of all joints", "angle", "\u00B0");
    add("input", excesses(given_), 6, panel);
    add("result", excesses(outcome_.motion.clip), 0, panel);
    widen(kFewDegrees, panel);
    return panel;
  }

 private:
  draw::Panel over_time(const char* title, const char* label, const char* unit) const {
    draw::Panel panel;
    panel.title = title;
    panel.x = {"time", "s"};
    if (times_.size() > 1) {
      panel.x.low = times_.front();
      panel.x.high = times_.back();
    }
    panel.y.label = label;
    panel.y.unit = unit;
    panel.y.low = 0;
    return panel;
  }

  static void widen(double least, draw::Panel& panel) {
    for (const draw::Series& series : panel.series) {
      for (const double value : series.y) {
        if (value >= least) return;
      }
    }
    panel.y.high = least;
  }

  void add(std::string name, std::vector<double> values, int colour, draw::Panel& panel) const {
    draw::Series series;
    series.name = std::move(name);
    series.x = times_;
    series.y = std::move(values);
    series.colour = colour;
    panel.series.push_back(std::move(series));
  }

  // Degrees, in each frame.
  std::vector<double> excesses(const Clip& clip) const {
    const auto& parents = clip.skeleton.parents;
    std::vector<Transform> world(parents.size()), local(parents.size());
    std::vector<double> largest;
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.get_pose(f, world);
      world_to_local(parents, world, local);
      double most = 0;
      for (std::size_t j = 1; j < local.size(); ++j) {
        most = std::max(most, excess(outcome_.limits[j], local[j].orientation));
      }
      largest.push_back(most / kRadiansPerDegree);
    }
    return largest;
  }

  const Outcome& outcome_;
  const Clip& given_;
  std::vector<double> times_;  // [frames], seconds
};

}  // namespace

draw::Chart chart_of(const Outcome& outcome, const Clip& given, const std::string& title) {
  const ChartMaker maker(outcome, given);
  draw::Chart chart;
  chart.title = title;
  for (const bool angles : {false, true}) {
    draw::Panel panel = maker.residuals(angles);
    if (!panel.series.empty()) chart.panels.push_back(std::move(panel));
  }
  if (!outcome.limits.empty()) {
    draw::Panel panel = maker.holders();
    if (!panel.series.empty()) chart.panels.push_back(std::move(panel));
    chart.panels.push_back(maker.beyond_limits());
  }
  chart.panel_height = 180;
  return chart;
}

}  // namespace krok::cli::ik
