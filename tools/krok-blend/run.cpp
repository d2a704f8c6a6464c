#include "tools/krok-blend/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "blend/blend_clips.h"
#include "blend/warp_by_shape.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/anim/anim.h"
#include "formats/io/open_motion.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"

namespace krok::cli::blend {

namespace {

using krok::blend::Blended;
using krok::blend::Correspondence;

struct Motion {
  std::string name;
  const InputFile* file = nullptr;
  FrameSource frames;
  Clip clip;  // without frames, where they are read in parts
  MotionKeys keys;
  bool has_keys = false;
  krok::blend::WeightCurve weight;
};

Status check_weights(const Options& options) {
  if (options.inputs.size() < 2) {
    return usage("one motion is given", "krok-blend A B blends two; krok-edit changes one");
  }
  const auto shares = std::ranges::count_if(options.inputs, &WeightedInput::is_equal_share);
  if (shares > 0 && shares < std::ssize(options.inputs)) {
    return Error("usage", "some motions have a weight and some do not",
                 "give each one, walk.anim:0.5, or none for equal shares");
  }
  return {};
}

// Everything but the clip, for which it has the skeleton, the rate and the provenance.
Result<Motion> read_motion(const Options& options, const WeightedInput& input, std::size_t bytes,
                           const FrameSource& frames, const Provenance& provenance,
                           const io::FindRoles& find_roles, ToolContext& context) {
  Motion motion;
  motion.name = name_of_input(input.path);
  motion.frames = frames;
  motion.clip = {frames.skeleton, frames.rate, {}, {}, provenance};
  warn_of_lost_speed(motion.name, motion.clip, context);
  if (input.is_equal_share()) {
    const auto shares = static_cast<double>(options.inputs.size());
    motion.weight = krok::blend::WeightCurve::constant(1.0 / shares);
  } else if (input.weight) {
    motion.weight = krok::blend::WeightCurve::constant(*input.weight);
  } else {
    auto curve = read_weight_curve(input.curve, context);
    if (!curve) return curve.error();
    motion.weight = std::move(*curve);
  }
  auto found =
      choose_keys(options.keys, input.path, bytes, frames, provenance, find_roles, context);
  if (!found) return found.error();
  motion.has_keys = found->has_value();
  if (motion.has_keys) motion.keys = std::move(**found);
  return motion;
}

// Calls `use` with all motions, opened within each other: a capture that proves damaged on the way
// is opened again, see io::stream_motion(). `motions` has a capacity for all of them.
Status use_motions(const Options& options, const io::FindRoles& find_roles, ToolContext& context,
                   std::vector<Motion>& motions, const std::function<Status()>& use) {
  if (motions.size() == options.inputs.size()) return use();
  const WeightedInput& input = options.inputs[motions.size()];
  const auto file = context.open_long_input(input.path);
  if (!file) return file.error();
  const io::ChecksumAtEnd checksum(*file, context);
  std::function<Provenance()> provenance;
  const auto with = [&](const FrameSource& frames) -> Status {
    auto motion = read_motion(options, input, file->bytes().size(), frames, provenance(),
                              find_roles, context);
    if (!motion) return motion.error();
    motion->file = &*file;
    motions.push_back(*std::move(motion));
    if (options.warp == WarpChoice::dtw || file->bytes().size() < kLongTake) {
      auto clip = load(frames, context.jobs);
      if (!clip) return clip.error();
      clip->provenance = provenance();
      motions.back().clip = *std::move(clip);
      motions.back().frames = frames_of(motions.back().clip);
    }
    Status status = use_motions(options, find_roles, context, motions, use);
    motions.pop_back();
    return status;
  };
  const auto read = io::stream_motion(*file, context, with, {.provenance = &provenance});
  return read ? Status() : Status(read.error());
}

// Corresponding times from keytimes, from poses (DTW), or from start and end.
Result<Correspondence> find_moments(const Options& options, const std::vector<Motion>& motions,
                                    const RoleMap& roles, ToolContext& context) {
  if (options.warp == WarpChoice::dtw) {
    std::vector<const Clip*> clips;
    for (const Motion& motion : motions) clips.push_back(&motion.clip);
    return krok::blend::warp_by_shape(clips, roles, {.jobs = context.jobs});
  }
  const auto ends = [&] {
    std::vector<double> durations;
    for (const Motion& motion : motions) durations.push_back(motion.frames.duration());
    return krok::blend::ends_alone(durations);
  };
  if (options.keys == KeysChoice::none) return ends();
  const auto lacks_keytimes = [](const Motion& motion) { return motion.keys.keytimes.empty(); };
  if (options.keys == KeysChoice::automatic && std::ranges::any_of(motions, lacks_keytimes)) {
    const auto& motion = *std::ranges::find_if(motions, lacks_keytimes);
    context.warn("blend-keys",
                 fmt::format("{} has no keytimes; the motions are matched from beginning to end",
                             motion.name),
                 "--warp dtw aligns them by their poses; krok-keys --keytime sets keytimes");
    return ends();
  }
  std::vector<krok::blend::KeyedMotion> keyed;
  for (const Motion& motion : motions) {
    keyed.push_back(
        {motion.name, motion.frames.duration(), &motion.keys, 2.1 / motion.frames.rate});
  }
  auto found = krok::blend::match_keytimes(keyed);
  if (found) context.diagnose(found->notes);
  return found;
}

// The source times of each frame in all motions, as a CSV table.
std::string warp_table(const std::vector<Motion>& motions, const Blended& blended) {
  std::string text = "time [s],generic";
  for (const Motion& motion : motions) {
    std::string name = motion.name;
    std::ranges::replace_if(
        name, [](char c) { return c == ',' || c == '"' || c == '\n'; }, '_');
    text += fmt::format(",{} [s]", name);
  }
  text += '\n';
  for (std::size_t f = 0; f < blended.generic.size(); ++f) {
    text += fmt::format("{:.6f},{:.6f}", static_cast<double>(f) / blended.clip.rate,
                        blended.generic[f]);
    for (const auto& times : blended.times) text += fmt::format(",{:.6f}", times[f]);
    text += '\n';
  }
  return text;
}

void warn_of_spread(const Blended& blended, ToolContext& context) {
  constexpr double kMax = kPi / 2;
  if (blended.widest_spread <= kMax) return;
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = "blend-spread";
  diagnostic.joint = blended.clip.skeleton.names[static_cast<std::size_t>(blended.spread_joint)];
  diagnostic.frame = blended.spread_frame;
  diagnostic.message = fmt::format(
      "the motions' rotations of {} differ by up to {:.0f} degrees (frame {}); blending "
      "rotations over 90 degrees apart is unreliable",
      diagnostic.joint, blended.widest_spread / kRadiansPerDegree, diagnostic.frame);
  diagnostic.hint = "check the result, and whether the keytimes correspond";
  context.diagnose(std::move(diagnostic));
}

// Writes the result and returns what is known of it then. With --plant it is held in memory.
Result<Blended> write_results(const Options& options, const std::vector<Motion>& motions,
                              const RoleMap& roles, const krok::blend::BlendedFrames& made,
                              std::optional<PlantDrift>& drift, ToolContext& context) {
  Blended blended;
  FrameSource frames = made.frames;
  if (options.plant) {
    auto clip = load(made.frames, context.jobs);
    if (!clip) return clip.error();
    blended = made.done();
    blended.clip = *std::move(clip);
    auto planted = plant_result(blended.clip, blended.keys, roles, context);
    if (!planted) return planted.error();
    drift = *planted;
    frames = frames_of(blended.clip);
  }
  const auto complete = [&] {
    if (!options.plant) blended = made.done();
    warn_of_spread(blended, context);
    for (const Motion& motion : motions) {
      context.note_checksum(*motion.file);
    }
    Provenance provenance = context.provenance();
    for (const Motion& motion : motions) {
      for (const std::string& conversion : motion.clip.provenance.conversions) {
        provenance.conversions.push_back(fmt::format("{}: {}", motion.name, conversion));
      }
    }
    return provenance;
  };
  OutputSet outputs(context);
  const anim::WriteOptions writing{.orientation = options.orientation,
                                   .jobs = thread_count(context.jobs)};
  Status status = outputs.add(context.output, [&](OutputFile& file) {
    return anim::write(frames, complete, writing, file);
  });
  if (status) {
    status = add_keys(blended.keys, frames.skeleton, frames.duration(), context.output, outputs);
  }
  if (status && !options.save_warp.empty()) {
    status = outputs.add(options.save_warp, warp_table(motions, blended));
  }
  if (status) status = outputs.finish();
  if (!status) return status.error();
  return blended;
}

krok::blend::Align align_of(AlignChoice choice, bool all_stand) {
  using krok::blend::Align;
  switch (choice) {
    case AlignChoice::root:
      return Align::root;
    case AlignChoice::stance:
      return Align::stance;
    case AlignChoice::none:
      return Align::none;
    default:
      return all_stand ? Align::stance : Align::root;
  }
}

double duration_of(const Blended& blended) {
  const auto frames = static_cast<double>(blended.generic.size());
  return frames < 2 ? 0 : (frames - 1) / blended.clip.rate;
}

void report(const std::vector<Motion>& motions, const Correspondence& moments,
            const Blended& blended, ToolContext& context) {
  Json list = Json::array();
  for (std::size_t m = 0; m < motions.size(); ++m) {
    Json entry;
    entry["name"] = motions[m].name;
    entry["weight"] = motions[m].weight.is_constant() ? Json(motions[m].weight.weights[0]) : Json();
    entry["times"] = moments.times[m];
    list.push_back(std::move(entry));
  }
  Json& result = context.report.result;
  const int frames = static_cast<int>(blended.generic.size());
  result["frames"] = frames;
  result["rate"] = blended.clip.rate;
  result["duration"] = duration_of(blended);
  result["moments"] = moments.names;
  result["motions"] = std::move(list);
  result["keytimes"] = to_json(blended.keys.keytimes);
  result["largest_spread_angle"] = to_degrees(blended.widest_spread);
}

Status blend_motions(const Options& options, const io::FindRoles& find_roles,
                     const std::vector<Motion>& motions, ToolContext& context) {
  const auto roles = find_roles(motions.front().frames.skeleton);
  if (!roles) return roles.error();
  const auto moments = find_moments(options, motions, *roles, context);
  if (!moments) return moments.error();

  std::vector<krok::blend::BlendSource> sources;
  for (const Motion& motion : motions) {
    sources.push_back(
        {motion.name, motion.frames, motion.has_keys ? &motion.keys : nullptr, motion.weight});
  }
  const auto stands = [](const Motion& motion) { return !motion.keys.contacts.empty(); };
  const bool all_stand = std::ranges::all_of(motions, stands);
  if (options.align == AlignChoice::stance && !all_stand) {
    context.warn("blend-stance",
                 fmt::format("{} has no contacts; its feet are not locked",
                             std::ranges::find_if_not(motions, stands)->name),
                 "krok-keys finds contacts, and --add-contact adds them");
  }
  krok::blend::BlendOptions how;
  how.warp =
      options.warp == WarpChoice::linear ? krok::blend::Warp::linear : krok::blend::Warp::pchip;
  how.align = align_of(options.align, all_stand);
  how.rate = options.rate;
  how.any_sum = options.modifier;
  how.jobs = context.jobs;
  const auto made = krok::blend::blend_frames(sources, *roles, *moments, how);
  if (!made) return made.error();
  std::optional<PlantDrift> drift;
  const auto blended = write_results(options, motions, *roles, *made, drift, context);
  if (!blended) return blended.error();
  report(motions, *moments, *blended, context);
  if (drift) {
    context.report.result["planted"] = to_json(*drift);
    context.log(text_of(*drift));
  }
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const FrameSource& frames = motions[m].frames;
    const double from = moments->times[m].front(), to = moments->times[m].back();
    if (from + frames.duration() - to < 1.5 / frames.rate) continue;
    context.log(fmt::format("{}: {} to {} s of {} s are used, what has a counterpart in the others",
                            motions[m].name, readable(from, 3), readable(to, 3),
                            readable(frames.duration(), 3)));
  }
  context.log(fmt::format("{} -> {}: {} at {} fps ({} s), {} matched times",
                          counted(motions.size(), "motion"), context.output,
                          counted(blended->generic.size(), "frame"), readable(blended->clip.rate),
                          readable(duration_of(*blended), 4), moments->moments()));
  return {};
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  if (Status status = check_weights(options); !status) return status.error();
  std::vector<Motion> motions;
  motions.reserve(options.inputs.size());
  Status result;  // kept aside, as an error is none of the last file
  const Status opened = use_motions(options, *find_roles, context, motions, [&] {
    result = blend_motions(options, *find_roles, motions, context);
    return Status();
  });
  if (!opened) return opened.error();
  if (!result) return result.error();
  return kExitDone;
}

}  // namespace krok::cli::blend
