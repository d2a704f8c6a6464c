#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contacts/loop_steps.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "motion/hips_root.h"
#include "motion/join.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "scene/frame_source.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-edit/event_time.h"
#include "tools/krok-edit/steps.h"

namespace krok::cli::edit {

namespace {

std::string seconds(double value) {
  return readable(value, 4) + " s";
}

const std::string& joint_name(const Edit& edit, int joint) {
  return edit.clip.skeleton.names[static_cast<std::size_t>(joint)];
}

std::string extent_of(const Edit& edit) {
  return fmt::format("the motion has {}, 0 to {}, {}", counted(edit.frame_count(), "frame"),
                     edit.frame_count() - 1, seconds(edit.source().duration()));
}

struct Range {
  double first = 0, last = 0;  // frames, may be fractional
};

// The frame range of a sequence.
Result<Range> range_of(const sequences::Sequence& sequence, const Options& options,
                       const Edit& edit) {
  const double file_rate = edit.sequences->rate;
  const double scale = file_rate > 0 ? edit.clip.rate / file_rate : 1;
  const Range range{sequence.first * scale, sequence.last * scale};
  if (range.last > edit.frame_count() - 1 + 1e-3) {
    return Error("edit-sequence",
                 fmt::format("'{}' ends at frame {}{}, but {}", sequence.name, sequence.last,
                             file_rate > 0 ? fmt::format(" at {} fps", readable(file_rate)) : "",
                             extent_of(edit)))
        .in_file(options.sequences);
  }
  return range;
}

Result<Range> named_range(const Options& options, Edit& edit) {
  const sequences::Sequence* sequence = edit.sequences->find(edit.sequence);
  if (sequence == nullptr) {
    return Error("edit-sequence", fmt::format("there is no sequence '{}'", edit.sequence),
                 "list them with --list-sequences")
        .in_file(options.sequences);
  }
  edit.speed *= sequence->speed;
  edit.loop = edit.loop || sequence->loop;
  return range_of(*sequence, options, edit);
}

Result<Range> typed_range(const Options& options, const Edit& edit) {
  const double end = edit.frame_count() - 1;
  // Keytimes are between frames: the nearest frame.
  const auto frame_of = [&](const std::optional<CutTime>& time,
                            double otherwise) -> Result<double> {
    if (!time) return otherwise;
    if (!time->event) return time->time.seconds(edit.clip.rate) * edit.clip.rate;
    const auto seconds = time_of(*time->event, edit.keytimes);
    if (!seconds) return Error(seconds.error()).in_file(options.input);
    return std::clamp(std::round(*seconds * edit.clip.rate), 0.0, end);
  };
  const auto first = frame_of(options.from, 0);
  if (!first) return first.error();
  const auto last = frame_of(options.to, end);
  if (!last) return last.error();
  const Range range{*first, *last};
  if (range.first > range.last) {
    return Error("edit-range",
                 fmt::format("--from ({}) is after {} ({})", seconds(range.first / edit.clip.rate),
                             options.to ? "--to" : "the end", seconds(range.last / edit.clip.rate)),
                 extent_of(edit));
  }
  // A printed duration may be rounded up.
  if (range.last >= end + 1) {
    const std::string frames = frame_hint(options.to->time, edit.frame_count());
    return Error("edit-range",
                 fmt::format("--to {} is after the end", seconds(range.last / edit.clip.rate)),
                 frames.empty() ? extent_of(edit) : extent_of(edit) + "; " + frames);
  }
  return range;
}

Json seam_json(const Seam& seam, const Edit& edit) {
  Json json;
  json["angle"] = to_degrees(seam.angle);
  json["angle_joint"] = joint_name(edit, seam.angle_joint);
  json["distance"] = seam.distance;
  json["angular_velocity"] = to_degrees(seam.angular_velocity);
  json["angular_velocity_joint"] = joint_name(edit, seam.angular_velocity_joint);
  json["usual_angular_velocity"] = to_degrees(seam.usual_angular_velocity);
  json["velocity"] = seam.velocity;
  return json;
}

// The pose error vanishes; the velocity error is reduced to what is usual within the motion.
std::string seam_text(const Looped& looped, const Edit& edit) {
  const Seam &before = looped.before, &after = looped.after;
  return fmt::format(
      "; at the seam, poses differed by at most {} ({}), now {}; velocities jumped by {}/s, now "
      "{}/s ({}, usual {}/s)",
      in_degrees(before.angle), joint_name(edit, before.angle_joint), in_degrees(after.angle),
      in_degrees(before.angular_velocity), in_degrees(after.angular_velocity),
      joint_name(edit, after.angular_velocity_joint), in_degrees(after.usual_angular_velocity));
}

Json loop_json(const Looped& looped, const Edit& edit) {
  Json json;
  json["period"] = looped.clip.duration();
  json["added_frames"] = looped.added_frames;
  json["blended_frames"] = looped.blended_frames;
  const Vec3& way = looped.displacement.position;
  json["displacement"] = {way.x(), way.y(), way.z()};
  json["turn"] = to_degrees(looped.turn);
  json["straightened"] = to_degrees(looped.straightened);
  json["levelled"] = looped.levelled;
  json["root_carried"] = looped.carried;
  json["seam_before"] = seam_json(looped.before, edit);
  json["seam_after"] = seam_json(looped.after, edit);
  return json;
}

std::string loop_text(const Looped& looped, const Edit& edit) {
  const int last = looped.clip.frame_count() - 1;
  const GroundFrame from = ground_frame(looped.clip, edit.carrier, 0);
  const GroundFrame to = ground_frame(looped.clip, edit.carrier, last);
  std::string line = fmt::format("looped: a cycle of {} ({}{}) moves by {} m",
                                 counted(last, "frame"), seconds(looped.clip.duration()),
                                 looped.added_frames > 0 ? ", closing frame added" : "",
                                 readable(std::hypot(to.x - from.x, to.z - from.z), 3));
  const Vec3& way = looped.displacement.position;
  if (way.y() != 0) line += fmt::format(", climbs {} m", readable(way.y(), 3));
  if (looped.turn != 0) line += fmt::format(", turns {}", in_degrees(looped.turn));
  if (looped.straightened != 0) {
    line += fmt::format("; a {} of {} straightened",
                        std::abs(looped.straightened) > kLoopDrift ? "turn" : "drift",
                        in_degrees(looped.straightened));
  }
  if (looped.carried) line += fmt::format("; {} now travels along", joint_name(edit, 0));
  return line + seam_text(looped, edit);
}

}  // namespace

Status check_sequences(const Options& options, const Edit& edit) {
  for (const sequences::Sequence& sequence : edit.sequences->sequences) {
    if (const auto range = range_of(sequence, options, edit); !range) return range.error();
  }
  return {};
}

Status cut_out(const Options& options, ToolContext&, Edit& edit) {
  edit.speed = options.speed;
  edit.loop = options.loop || options.cycle != CycleFoot::none;
  const bool named = !edit.sequence.empty();
  const bool cycle = options.cycle != CycleFoot::none;
  if (!named && !cycle && !options.from && !options.to) return {};
  if (edit.frame_count() == 0) {
    return Error("edit-range", "the motion has no frames to cut from").in_file(options.input);
  }
  const auto range = named ? named_range(options, edit) : typed_range(options, edit);
  if (!range) return range.error();
  constexpr double kSameFrame = 1e-3;
  const int end = edit.frame_count() - 1;
  int first = static_cast<int>(std::ceil(range->first - kSameFrame));
  int last = std::min(end, static_cast<int>(std::floor(range->last + kSameFrame)));
  if (first > last) {
    return Error("edit-range",
                 fmt::format("no frame between {} and {}", seconds(range->first / edit.clip.rate),
                             seconds(range->last / edit.clip.rate)),
                 extent_of(edit))
        .in_file(options.input);
  }
  Json metrics;
  std::string chosen = named ? fmt::format("sequence '{}', ", edit.sequence) : "";
  if (named) metrics["sequence"] = edit.sequence;
  if (cycle) {
    const auto best =
        best_cycle(edit.clip, edit.carrier, edit.keytimes, options.cycle, first, last);
    if (!best) return Error(best.error()).in_file(options.input);
    first = best->first;
    last = best->last;
    metrics["cycle"] = {{"from", fmt::format("{}[{}]", best->name, best->number)},
                        {"to", fmt::format("{}[{}]", best->name, best->number + 1)},
                        {"angle", to_degrees(best->angle)},
                        {"compared", best->compared},
                        {"straight", best->straight}};
    const std::string among =
        best->straight > 0 && best->straight < best->compared
            ? fmt::format("{} straight ones of {}", best->straight, best->compared)
            : std::to_string(best->compared);
    chosen = fmt::format("cycle {}[{}] to [{}], of {} the one that matches best, ", best->name,
                         best->number, best->number + 1, among);
  }
  const FrameSource source = edit.source();
  FrameSource kept = part_of(source, first, last + 1 - first);
  if (source.release) {
    kept.release = [first, release = source.release](int frame) { release(first + frame); };
  }
  if (Status status = edit.take(std::move(kept)); !status) return status;
  metrics["first_frame"] = first;
  metrics["last_frame"] = last;
  metrics["frames_cut"] = end + 1 - edit.frame_count();
  edit.note("cut", std::move(metrics),
            fmt::format("cut: {}frames {} to {}, {} removed", chosen, first, last,
                        end + 1 - edit.frame_count()));
  return {};
}

Status mirror_sides(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.mirror) return {};
  const MirrorPairs pairs = find_mirror_pairs(edit.clip.skeleton, edit.roles);
  Json pair_list = Json::array(), middle = Json::array(), unpaired = Json::array();
  for (int j = 0; j < edit.clip.joint_count(); ++j) {
    const int other = pairs.partners[static_cast<std::size_t>(j)];
    if (other == j) middle.push_back(joint_name(edit, j));
    if (other > j) pair_list.push_back({joint_name(edit, j), joint_name(edit, other)});
  }
  if (pair_list.empty()) {
    context.warn(
        "edit-unpaired",
        "no joints were recognised as left and right; only the path and heading are mirrored",
        "list joint roles with krok-info");
  }
  for (const int j : pairs.unpaired()) {
    const std::string name = joint_name(edit, j);
    unpaired.push_back(name);
    if (edit.clip.skeleton.end_sites[static_cast<std::size_t>(j)] != 0) continue;
    Diagnostic warning = make_warning(
        "edit-unpaired", name + " has no counterpart on the other side; it follows its parent");
    warning.joint = name;
    context.diagnose_in(options.input, {warning});
  }
  Status status = edit.take(mirror(edit.source(), pairs, thread_count(context.jobs)));
  if (!status) return status;
  if (auto& removed = edit.clip.provenance.removed_root_motion) {
    removed->velocity.x() *= -1;
    removed->turn_rate *= -1;
  }
  std::string line =
      fmt::format("mirrored: {}, {} in the middle", counted(pair_list.size(), "pair"),
                  counted(middle.size(), "joint"));
  Json metrics;
  metrics["pairs"] = std::move(pair_list);
  metrics["middle"] = std::move(middle);
  metrics["unpaired"] = std::move(unpaired);
  edit.note("mirror", std::move(metrics), std::move(line));
  return {};
}

Status change_timing(const Options& options, ToolContext& context, Edit& edit) {
  constexpr double kHardlyMeant = 20;
  const double rate = options.resample.value_or(edit.clip.rate);
  if (!options.resample && edit.speed == 1) return {};
  const FrameSource before = edit.source();
  const double duration = before.duration();
  const Interpolation& how = options.interpolation;
  // The pose that a loop ends with is the first one: without it, it has a gap.
  const bool closes = !edit.frames && loop_displacement(edit.clip, edit.carrier);
  if (how.hermite) {
    auto retimed = retime_on_curves(edit.clip, rate, edit.speed, how.tension, closes || edit.loop);
    if (!retimed) return retimed.error();
    edit.clip = std::move(*retimed);
  } else {
    const LastFrame last =
        closes || edit.loop || edit.kept_loop ? LastFrame::kept : LastFrame::within;
    Status status = edit.take(retime(before, rate, edit.speed, last));
    if (!status) return status;
  }
  if (auto& removed = edit.clip.provenance.removed_root_motion) {
    removed->velocity *= edit.speed;
    removed->turn_rate *= edit.speed;
  }
  Json metrics;
  metrics["speed"] = edit.speed;
  metrics["rate_before"] = before.rate;
  metrics["rate"] = rate;
  metrics["frames_before"] = before.frame_count;
  metrics["frames"] = edit.frame_count();
  std::string line;
  if (edit.speed >= kHardlyMeant) {
    context.warn("edit-speed",
                 fmt::format("the motion is played {} times as fast", readable(edit.speed)),
                 "a speed is a factor, 0.5 for 50 %");
  }
  if (edit.speed != 1) {
    line = fmt::format("speed {}: {} become {}", readable(edit.speed), seconds(before.duration()),
                       seconds(edit.source().duration()));
  }
  if (options.resample) {
    line += fmt::format("{}resampled from {} to {} fps", line.empty() ? "" : ", ",
                        readable(before.rate), readable(rate));
    const double made = edit.source().duration() * edit.speed;
    if (closes && std::abs(made - duration) > 1e-6) {
      line += fmt::format(", {} become {} so that the loop stays closed", seconds(duration),
                          seconds(made));
    }
  }
  if (how.hermite) {
    metrics["tension"] = how.tension;
    line += fmt::format(", along Hermite curves of tension {}", readable(how.tension));
  }
  edit.note("timing", std::move(metrics), std::move(line));
  return {};
}

// Degrees that poses differ by where motions meet; walks in step differ by up to 27, those half a
// cycle apart by 37 to 71.
constexpr double kPoorJoin = 35;

Status append_motions(const Options& options, ToolContext& context, Edit& edit) {
  for (std::size_t i = 0; i < edit.appended.size(); ++i) {
    const std::string& path = options.append[i];
    const FrameSource& next = edit.appended[i];
    const JoinOptions joining{options.append_blend.seconds(edit.clip.rate), options.match_height,
                              edit.roles.joint(Role::chest)};
    auto joined = join(edit.source(), next, edit.carrier, joining, thread_count(context.jobs));
    if (!joined) return std::move(joined.error()).in_file(path);
    const int frames = edit.frame_count();
    if (Status status = edit.take(joined->frames); !status) return status;
    edit.clip.provenance.removed_root_motion.reset();
    Json metrics;
    metrics["file"] = base_name(path);
    metrics["frames_before"] = frames;
    metrics["frames"] = edit.frame_count();
    metrics["joint_frame"] = joined->joint_frame;
    metrics["shared_frames"] = joined->shared_frames;
    metrics["largest_angle"] = to_degrees(joined->largest_angle);
    metrics["largest_angle_joint"] = joint_name(edit, joined->largest_joint);
    std::string line = fmt::format("appended {}: {} shared about frame {}", base_name(path),
                                   counted(joined->shared_frames, "frame"), joined->joint_frame);
    if (joined->largest_angle > 0) {
      line +=
          fmt::format(", poses there differ by at most {} ({})", in_degrees(joined->largest_angle),
                      joint_name(edit, joined->largest_joint));
    }
    if (next.rate != edit.clip.rate) {
      line += fmt::format(", resampled from {} fps", readable(next.rate));
    }
    edit.note("append", std::move(metrics), std::move(line));
    if (to_degrees(joined->largest_angle) > kPoorJoin) {
      context.warn("edit-join",
                   fmt::format("poses where {} is appended differ by up to {} ({}), so feet may "
                               "slide there",
                               base_name(path), in_degrees(joined->largest_angle),
                               joint_name(edit, joined->largest_joint)),
                   "cut both where their poses are alike (--from, --to), or use krok-mix, which "
                   "keeps walks in step");
    }
  }
  return {};
}

// Degrees that poses differ by at the ends of a clip that is hardly one cycle; those of captured
// cycles from strike to strike differ by 3 to 12.
constexpr double kPoorSeam = 20;

Status make_loop(const Options& options, ToolContext& context, Edit& edit) {
  if (!edit.loop) {
    if (!options.rounds) return {};
    return Error("usage", "--rounds needs a loop", "add --loop");
  }
  if (Status status = edit.hold(context.jobs); !status) return status;
  LoopOptions looping = options.looping;
  looping.blend = options.loop_blend.seconds(edit.clip.rate);
  if (looping.blend > std::max(1.0, edit.clip.duration())) {
    return usage(fmt::format("--loop-blend {}s is longer than the loop of {}s",
                             readable(looping.blend, 3), readable(edit.clip.duration(), 3)),
                 fmt::format("write {}f for frames", readable(options.loop_blend.value)));
  }
  // From strike to strike the last pose is the first again.
  if (options.cycle != CycleFoot::none && looping.end == LoopEnd::automatic) {
    looping.end = LoopEnd::closed;
  }
  // Where whoever plays the loop turns it again, feet stay on the ground of the path that turns.
  const bool turned_again =
      looping.turn == LoopTurn::straighten && (options.in_place || options.treadmill);
  if (turned_again) looping.turn = LoopTurn::automatic;
  auto looped = loop(edit.clip, edit.carrier, looping);
  if (!looped) return std::move(looped.error()).in_file(options.input);
  const auto drift = plant_loop(options, edit, *looped);
  if (!drift) return drift.error();
  if (turned_again && looped->turn != 0) straighten(edit.carrier, *looped);
  // Up to kLoopDrift it is a capture's drift, which nobody wants back.
  if (std::abs(looped->straightened) > kLoopDrift) {
    edit.turn_rate = looped->straightened / looped->clip.duration();
  }
  if (looped->turn != 0 && (options.in_place || options.treadmill)) {
    context.warn("edit-turn",
                 fmt::format("the loop turns by {} in each cycle, which is not taken out: in place "
                             "it jumps back at its end",
                             in_degrees(looped->turn)),
                 "--loop-turn straighten takes the turn out, and keeps its rate");
  }
  const double climb = looped->displacement.position.y();
  if (climb != 0 && (options.in_place || options.treadmill)) {
    if (options.game_loop) edit.climb_rate = climb / looped->clip.duration();
    context.warn("edit-climb",
                 fmt::format("the loop gains {} m in height in each cycle{}", readable(climb, 3),
                             options.game_loop ? ", which is part of the velocity that is stored"
                                               : ": in place it jumps back at its end"),
                 options.game_loop
                     ? "--loop-climb level blends it away at the seam"
                     : "--loop-climb level blends it away at the seam, --game-loop takes it out");
  }
  Json metrics = loop_json(*looped, edit);
  std::string line = loop_text(*looped, edit);
  if (options.plant) {
    metrics["drift"] = *drift;
    line += fmt::format("; planted feet drift by up to {}", millimetres(*drift));
  }
  if (to_degrees(looped->before.angle) > kPoorSeam) {
    context.warn("edit-seam",
                 fmt::format("poses at both ends differ by up to {} ({}), which the loop spreads "
                             "over {} frames on either side",
                             in_degrees(looped->before.angle),
                             joint_name(edit, looped->before.angle_joint), looped->blended_frames),
                 options.cycle == CycleFoot::none
                     ? "choose ends at the same moment of a cycle: --cycle auto, or --from and --to"
                     : "no cycle of the motion repeats better: choose its ends with --from, --to "
                       "and --loop, or --loop-blend 0.4s for a longer transition");
  }
  edit.clip = std::move(looped->clip);
  if (options.rounds) {
    auto all = repeated(edit.clip, looped->displacement, *options.rounds);
    if (!all) return all.error();
    edit.clip = std::move(*all);
    metrics["rounds"] = *options.rounds;
    line += fmt::format("; {}", counted(*options.rounds, "cycle"));
  }
  edit.note("loop", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
