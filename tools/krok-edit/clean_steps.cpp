#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "capture/rest_frame.h"
#include "contacts/contacts.h"
#include "contacts/legs.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "filter/noise_filter.h"
#include "motion/hips_root.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "scene/frame_source.h"
#include "tools/krok-edit/steps.h"
#include "tools/shared/planting.h"

namespace krok::cli::edit {

namespace {

// How far foot contacts moved: the error that a filter adds to ground contact.
Json foot_change(const Displacement& change, const Edit& edit, std::string& line) {
  const auto feet = foot_joints(edit.clip.skeleton, edit.roles);
  const std::string& name = edit.clip.skeleton.names[static_cast<std::size_t>(change.joint)];
  const bool known = feet.size() < edit.clip.skeleton.names.size();
  line += change.distance == 0
              ? fmt::format("; {} did not move", known ? "feet" : "joints")
              : fmt::format("; {} moved by at most {} ({}, frame {})", known ? "feet" : "joints",
                            millimetres(change.distance), name, change.frame);
  Json json;
  json["distance"] = change.distance;
  json["joint"] = name;
  json["frame"] = change.frame;
  return json;
}

Json foot_change(const Clip& before, const Edit& edit, std::string& line) {
  const auto feet = foot_joints(edit.clip.skeleton, edit.roles);
  return foot_change(largest_displacement(before, edit.clip, feet), edit, line);
}

Diagnostic spike_note(const filter::Spike& spike, const Edit& edit, const std::string& file) {
  Diagnostic note;
  note.severity = Severity::note;
  note.code = "edit-spike";
  note.where.file = file;
  note.joint = edit.clip.skeleton.names[static_cast<std::size_t>(spike.joint)];
  note.frame = spike.first_frame;
  const std::string frames =
      spike.first_frame == spike.last_frame
          ? fmt::format("frame {}", spike.first_frame)
          : fmt::format("frames {} to {}", spike.first_frame, spike.last_frame);
  note.message = fmt::format("{}, {}: the {} jumped by {} and back; replaced", note.joint, frames,
                             spike.of_position ? "position" : "rotation",
                             spike.of_position ? millimetres(spike.size) : in_degrees(spike.size));
  return note;
}

// Reports spikes, and adds them to `metrics`. A line on how many there are.
std::string report_spikes(const std::vector<filter::Spike>& spikes, const Options& options,
                          ToolContext& context, const Edit& edit, Json& metrics) {
  Json list = Json::array();
  int frames = 0;
  for (const filter::Spike& spike : spikes) {
    context.diagnose(spike_note(spike, edit, options.input));
    Json entry;
    entry["joint"] = edit.clip.skeleton.names[static_cast<std::size_t>(spike.joint)];
    entry["first_frame"] = spike.first_frame;
    entry["last_frame"] = spike.last_frame;
    entry["of"] = spike.of_position ? "position" : "rotation";
    entry["size"] = spike.of_position ? spike.size : to_degrees(spike.size);
    entry["unit"] = spike.of_position ? "m" : "deg";
    list.push_back(std::move(entry));
    frames += spike.last_frame - spike.first_frame + 1;
  }
  metrics["spikes"] = std::move(list);
  if (spikes.empty()) return "no spikes found";
  return fmt::format("{} removed, {} replaced", counted(spikes.size(), "spike"),
                     counted(frames, "joint's frame", "joints' frames"));
}

// What cleaning changed in a long take, known when its frames are written.
class Changes {
 public:
  explicit Changes(const Edit& edit) : feet_(foot_joints(edit.clip.skeleton, edit.roles)) {}

  // A block may be made more than once.
  void add(const FrameRun& before, const Clip& after, std::vector<filter::Spike> spikes = {}) {
    Displacement change =
        largest_displacement(before.clip, after, feet_, before.kept_begin, before.kept_end);
    change.frame += before.first;
    if (change.distance > largest_.distance) largest_ = change;
    spikes_[before.first + before.kept_begin] = std::move(spikes);
  }

  const Displacement& largest() const { return largest_; }

  // In the order of filter::SpikeRemoval.
  std::vector<filter::Spike> spikes() const {
    std::vector<filter::Spike> all;
    for (const auto& [frame, of_block] : spikes_) {
      all.insert(all.end(), of_block.begin(), of_block.end());
    }
    std::ranges::stable_sort(all, {}, [](const filter::Spike& spike) {
      return std::tuple(spike.joint, spike.of_position);
    });
    return all;
  }

 private:
  std::vector<int> feet_;
  Displacement largest_;
  std::map<int, std::vector<filter::Spike>> spikes_;  // by the first frame kept of their block
};

// The spikes are reported as the frames are written.
Status remove_spikes_of_frames(const filter::SpikeOptions& finding, const Options& options,
                               ToolContext& context, std::span<const std::uint8_t> joints,
                               Edit& edit) {
  const auto changes = std::make_shared<Changes>(edit);
  const auto watch = [changes](const FrameRun& before, const filter::SpikeRemoval& after) {
    changes->add(before, after.clip, after.spikes);
  };
  edit.note("spikes", {{"threshold", finding.threshold}}, "");
  edit.complete_note([changes, &options, &context](Edit& written, Json& metrics) {
    std::string line = report_spikes(changes->spikes(), options, context, written, metrics);
    if (!metrics["spikes"].empty()) {
      metrics["feet_moved"] = foot_change(changes->largest(), written, line);
    }
    return line;
  });
  return edit.take(
      filter::remove_spikes(*edit.frames, finding, joints, thread_count(context.jobs), watch));
}

Status remove_spikes(const Options& options, ToolContext& context,
                     std::span<const std::uint8_t> joints, Edit& edit) {
  if (!options.spikes) return {};
  filter::SpikeOptions finding;
  finding.threshold = options.spike_threshold;
  if (edit.frames) return remove_spikes_of_frames(finding, options, context, joints, edit);
  auto removal = filter::remove_spikes(edit.clip, finding, joints, thread_count(context.jobs));
  if (!removal) return removal.error();
  Json metrics;
  metrics["threshold"] = finding.threshold;
  std::string line = report_spikes(removal->spikes, options, context, edit, metrics);
  std::swap(edit.clip, removal->clip);
  if (!removal->spikes.empty()) metrics["feet_moved"] = foot_change(removal->clip, edit, line);
  edit.note("spikes", std::move(metrics), std::move(line));
  return {};
}

std::string noise_line(double angle, double distance, const std::string& spikes) {
  return fmt::format("filtered: noise of {} and {}, {}", in_degrees(angle), millimetres(distance),
                     spikes);
}

Status filter_noise_of_frames(const Options& options, ToolContext& context,
                              std::span<const std::uint8_t> joints, Edit& edit) {
  const auto changes = std::make_shared<Changes>(edit);
  const auto watch = [changes](const FrameRun& before, const filter::NoiseRemoval& after) {
    changes->add(before, after.clip, after.spikes);
  };
  auto made = filter::remove_noise(*edit.frames, joints, thread_count(context.jobs), watch);
  if (!made) return made.error();
  edit.note("filter",
            {{"kind", "auto"},
             {"noise_angle", to_degrees(made->angle)},
             {"noise_distance", made->distance}},
            "");
  edit.complete_note([changes, angle = made->angle, distance = made->distance, &options, &context](
                         Edit& written, Json& metrics) {
    const std::string spikes = report_spikes(changes->spikes(), options, context, written, metrics);
    std::string line = noise_line(angle, distance, spikes);
    metrics["feet_moved"] = foot_change(changes->largest(), written, line);
    return line;
  });
  return edit.take(std::move(made->frames));
}

Status filter_noise(const Options& options, ToolContext& context,
                    std::span<const std::uint8_t> joints, Edit& edit) {
  if (options.filter != Filter::by_noise) return {};
  if (edit.frames) return filter_noise_of_frames(options, context, joints, edit);
  auto removal = filter::remove_noise(edit.clip, joints, thread_count(context.jobs));
  if (!removal) return removal.error();
  Json metrics;
  metrics["kind"] = "auto";
  metrics["noise_angle"] = to_degrees(removal->angle);
  metrics["noise_distance"] = removal->distance;
  const std::string spikes = report_spikes(removal->spikes, options, context, edit, metrics);
  std::swap(edit.clip, removal->clip);
  std::string line = noise_line(removal->angle, removal->distance, spikes);
  metrics["feet_moved"] = foot_change(removal->clip, edit, line);
  edit.note("filter", std::move(metrics), std::move(line));
  return {};
}

// The frames are filtered as they are written, so how far feet moved is known only then.
Status smooth_frames(const filter::Smoothing& smoothing, std::span<const std::uint8_t> joints,
                     int jobs, const std::shared_ptr<Changes>& changes, Edit& edit) {
  const auto watch = [changes](const FrameRun& before, const Clip& after) {
    changes->add(before, after);
  };
  return edit.take(filter::smooth(*edit.frames, smoothing, joints, jobs, watch));
}

Status filter_jitter(const Options& options, ToolContext& context,
                     std::span<const std::uint8_t> joints, Edit& edit) {
  const auto smoothing = options.smoothing();
  if (!smoothing) return {};
  const int jobs = thread_count(context.jobs);
  Clip before;
  const auto changes = std::make_shared<Changes>(edit);
  if (edit.frames) {
    if (Status status = smooth_frames(*smoothing, joints, jobs, changes, edit); !status) {
      return status;
    }
  } else {
    auto smoothed = filter::smooth(edit.clip, *smoothing, joints, jobs);
    if (!smoothed) return smoothed.error();
    before = std::exchange(edit.clip, *std::move(smoothed));
  }
  long long count = 0;
  for (const std::uint8_t selected : joints) count += selected;
  Json metrics;
  std::string line;
  if (const auto* low_pass = std::get_if<filter::Butterworth>(&*smoothing)) {
    metrics["kind"] = "butterworth";
    metrics["cutoff"] = low_pass->cutoff;
    metrics["order"] = low_pass->order;
    if (low_pass->cutoff < 1) {
      context.warn("edit-cutoff",
                   fmt::format("a cutoff of {} Hz removes most of a motion, not jitter alone",
                               readable(low_pass->cutoff)),
                   "6 Hz is usual for walks, 10 Hz and more for what is fast");
    }
    line = fmt::format("filtered: Butterworth, {} Hz, order {}, zero phase",
                       readable(low_pass->cutoff), low_pass->order);
  } else {
    const auto& polynomial = std::get<filter::SavitzkyGolay>(*smoothing);
    metrics["kind"] = "savgol";
    metrics["window"] = polynomial.window;
    metrics["degree"] = polynomial.degree;
    line = fmt::format("filtered: Savitzky-Golay, {} frames, degree {}", polynomial.window,
                       polynomial.degree);
    if (edit.frame_count() < polynomial.window) {
      context.warn("edit-short",
                   fmt::format("the motion's {} are fewer than the window's {}: not filtered",
                               counted(edit.frame_count(), "frame"), polynomial.window),
                   "choose a smaller --window");
      line += " (too short: unchanged)";
    }
  }
  metrics["joints"] = count;
  line += fmt::format(", {}", counted(count, "joint"));
  if (!edit.frames) metrics["feet_moved"] = foot_change(before, edit, line);
  edit.note("filter", std::move(metrics), line);
  if (edit.frames) {
    edit.complete_note([changes, line](Edit& written, Json& made) {
      std::string whole = line;
      made["feet_moved"] = foot_change(changes->largest(), written, whole);
      return whole;
    });
  }
  return {};
}

// The feet are planted as frames are written.
Status plant_frames(ToolContext& context, Edit& edit) {
  auto planted = cli::plant_frames(*edit.frames, edit.roles, edit.contacts,
                                   edit.clip.provenance.removed_root_motion, context);
  edit.note("plant", {}, "");
  edit.complete_note([done = std::move(planted.done), given = edit.contacts.has_value(), &context](
                         Edit&, Json& metrics) {
    const PlantedFeet all = done();
    context.diagnose(all.warnings);
    metrics.update(planting_json(all, given));
    return planting_line(all);
  });
  return edit.take(std::move(planted.frames));
}

// A rest pose in front of the motion is no noise: the frames after it would be drawn towards it.
Status warn_of_rest_frame(const Options& options, ToolContext& context, const Edit& edit) {
  constexpr int kExamined = 12;  // by find_rest_pose()
  if (!options.spikes && options.filter == Filter::none) return {};
  const FrameSource frames = edit.frames ? *edit.frames : frames_of(edit.clip);
  const auto start = load(part_of(frames, 0, std::min(kExamined, frames.frame_count)), 1);
  if (!start) return start.error();
  const RestPose rest = find_rest_pose(*start, edit.roles);
  if (!rest.first_frame_is_rest) return {};
  context.warn("edit-rest-frame", rest.reason + ": it spoils what is filtered",
               "krok-edit --from 1f in a run before cuts it off");
  return {};
}

// How far the heels and balls of three cycles move in a loop while they stand, metres. The first
// and last stays may be cut off.
Result<double> drift_of(const std::vector<FixedStay>& stays, const Looped& looped, int carrier) {
  auto cycles = repeated(looped.clip, looped.displacement, 3);
  if (!cycles) return cycles.error();
  if (auto moving = travelling(*cycles, carrier)) cycles = *std::move(moving);
  const int period = looped.clip.frame_count() - 1;
  double drift = 0;
  for (const FixedStay& stay : stays) {
    if (stay.point.part == FootPart::tip || stay.last < period || stay.first > 2 * period) continue;
    Eigen::AlignedBox3d places;
    for (int f = stay.first; f <= stay.last; ++f) {
      places.extend(joint_at(*cycles, f, stay.point.joint) * stay.point.offset);
    }
    drift = std::max(drift, places.diagonal().norm());
  }
  return drift;
}

}  // namespace

Status clean(const Options& options, ToolContext& context, Edit& edit) {
  if (Status status = warn_of_rest_frame(options, context, edit); !status) return status;
  const auto joints = select_joints(edit.clip.skeleton, options.joints);
  if (!joints) return joints.error();
  if (Status status = remove_spikes(options, context, *joints, edit); !status) return status;
  if (Status status = filter_jitter(options, context, *joints, edit); !status) return status;
  if (Status status = filter_noise(options, context, *joints, edit); !status) return status;
  return plant(options, context, edit);
}

Status plant(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.plant) return {};
  if (edit.frames) return plant_frames(context, edit);
  auto planted = cli::plant(edit.clip, edit.roles, edit.contacts);
  if (!planted) return planted.error();
  context.diagnose(planted->warnings);
  Json metrics = planting_json(*planted, edit.contacts.has_value());
  std::string line = planting_line(*planted);
  edit.clip = std::move(planted->clip);
  edit.note("plant", std::move(metrics), std::move(line));
  return {};
}

Result<double> plant_loop(const Options& options, const Edit& edit, Looped& looped) {
  if (!options.plant) return 0.0;
  constexpr int kCycles = 3;
  const auto cycles = repeated(looped.clip, looped.displacement, kCycles);
  if (!cycles) return cycles.error();
  const auto moving = travelling(*cycles, edit.carrier);
  auto contacts = find_contacts(moving ? *moving : *cycles, edit.roles);
  if (!contacts) return contacts.error();
  // A loop in which no foot is in contact has nothing to hold.
  const auto planted = cli::plant(*cycles, edit.roles, std::move(contacts->contacts));
  if (!planted) return 0.0;
  const int period = looped.clip.frame_count() - 1;
  Clip middle = cut(planted->clip, period, 2 * period);
  move_clip(looped.displacement.inverse(), middle);
  // Closes what is left at the seam.
  const LoopOptions closing{
      options.loop_blend.seconds(edit.clip.rate), LoopEnd::closed,
      looped.turn == 0 ? LoopTurn::straighten : LoopTurn::keep,
      looped.displacement.position.y() == 0 ? LoopClimb::level : LoopClimb::keep};
  auto closed = loop(middle, edit.carrier, closing);
  if (!closed) return closed.error();
  looped.clip = std::move(closed->clip);
  looped.displacement = closed->displacement;
  return drift_of(planted->stays, looped, edit.carrier);
}

}  // namespace krok::cli::edit
