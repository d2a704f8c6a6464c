#include "tools/krok-blend/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "blend/warp_by_shape.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/open_motion.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/cli/usage.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"

namespace krok::cli::blend {

namespace {

using krok::blend::Blended;
using krok::blend::BlendInput;
using krok::blend::Correspondence;

struct Motion {
  std::string name;
  Clip clip;
  MotionKeys keys;
  bool has_keys = false;
  krok::blend::WeightCurve weight;
};

Result<std::vector<Motion>> read_motions(const Options& options, const io::FindRoles& find_roles,
                                         ToolContext& context) {
  std::vector<Motion> motions;
  if (options.inputs.size() < 2) {
    return usage("one motion is given", "krok-blend A B blends two; krok-edit changes one");
  }
  const auto shares = static_cast<std::size_t>(
      std::ranges::count_if(options.inputs, &WeightedInput::is_equal_share));
  if (shares > 0 && shares < options.inputs.size()) {
    return Error("usage", "some motions have a weight and some do not",
                 "give each one, walk.anim:0.5, or none for equal shares");
  }
  for (const WeightedInput& input : options.inputs) {
    auto clip = io::open_motion(input.path, context);
    if (!clip) return clip.error();
    Motion motion;
    motion.name = name_of_input(input.path);
    motion.clip = std::move(*clip);
    warn_of_lost_speed(motion.name, motion.clip, context);
    if (input.is_equal_share()) {
      motion.weight = krok::blend::WeightCurve::constant(1.0 / static_cast<double>(shares));
    } else if (input.weight) {
      motion.weight = krok::blend::WeightCurve::constant(*input.weight);
    } else {
      auto curve = read_weight_curve(input.curve, context);
      if (!curve) return curve.error();
      motion.weight = std::move(*curve);
    }
    auto found =
        choose_keys(options.keys, input.path, motion.name, motion.clip, find_roles, context);
    if (!found) return found.error();
    motion.has_keys = found->has_value();
    if (motion.has_keys) motion.keys = std::move(**found);
    motions.push_back(std::move(motion));
  }
  return motions;
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
    for (const Motion& motion : motions) durations.push_back(motion.clip.duration());
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
    keyed.push_back({motion.name, motion.clip.duration(), &motion.keys, 2.1 / motion.clip.rate});
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

Status write_results(const Options& options, const std::vector<Motion>& motions, Blended& blended,
                     ToolContext& context) {
  blended.clip.provenance = context.provenance();
  for (const Motion& motion : motions) {
    for (const std::string& conversion : motion.clip.provenance.conversions) {
      blended.clip.provenance.conversions.push_back(fmt::format("{}: {}", motion.name, conversion));
    }
  }
  OutputSet outputs(context);
  Status status = add_motion(blended.clip, blended.keys, options.orientation, context.output,
                             context.jobs, outputs);
  if (status && !options.save_warp.empty()) {
    status = outputs.add(options.save_warp, warp_table(motions, blended));
  }
  return status ? outputs.finish() : status;
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
  result["frames"] = blended.clip.frame_count();
  result["rate"] = blended.clip.rate;
  result["duration"] = blended.clip.duration();
  result["moments"] = moments.names;
  result["motions"] = std::move(list);
  result["keytimes"] = to_json(blended.keys.keytimes);
  result["largest_spread_angle"] = to_degrees(blended.widest_spread);
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto motions = read_motions(options, *find_roles, context);
  if (!motions) return motions.error();
  const auto roles = (*find_roles)(motions->front().clip.skeleton);
  if (!roles) return roles.error();
  const auto moments = find_moments(options, *motions, *roles, context);
  if (!moments) return moments.error();

  std::vector<BlendInput> inputs;
  for (const Motion& motion : *motions) {
    inputs.push_back(
        {motion.name, &motion.clip, motion.has_keys ? &motion.keys : nullptr, motion.weight});
  }
  const auto stands = [](const Motion& motion) { return !motion.keys.contacts.empty(); };
  const bool all_stand = std::ranges::all_of(*motions, stands);
  if (options.align == AlignChoice::stance && !all_stand) {
    context.warn("blend-stance",
                 fmt::format("{} has no contacts; its feet are not locked",
                             std::ranges::find_if_not(*motions, stands)->name),
                 "krok-keys finds contacts, and --add-contact adds them");
  }
  krok::blend::BlendOptions how;
  how.warp =
      options.warp == WarpChoice::linear ? krok::blend::Warp::linear : krok::blend::Warp::pchip;
  how.align = align_of(options.align, all_stand);
  how.rate = options.rate;
  how.any_sum = options.modifier;
  how.jobs = context.jobs;
  auto blended = krok::blend::blend_clips(inputs, *roles, *moments, how);
  if (!blended) return blended.error();
  warn_of_spread(*blended, context);
  std::optional<PlantDrift> drift;
  if (options.plant) {
    auto planted = plant_result(blended->clip, blended->keys, *roles, context);
    if (!planted) return planted.error();
    drift = *planted;
  }
  if (Status status = write_results(options, *motions, *blended, context); !status) {
    return status.error();
  }
  report(*motions, *moments, *blended, context);
  if (drift) {
    context.report.result["planted"] = to_json(*drift);
    context.log(text_of(*drift));
  }
  for (std::size_t m = 0; m < motions->size(); ++m) {
    const Clip& clip = (*motions)[m].clip;
    const double from = moments->times[m].front(), to = moments->times[m].back();
    if (from + clip.duration() - to < 1.5 / clip.rate) continue;
    context.log(fmt::format("{}: {} to {} s of {} s are used, what has a counterpart in the others",
                            (*motions)[m].name, readable(from, 3), readable(to, 3),
                            readable(clip.duration(), 3)));
  }
  context.log(fmt::format(
      "{} -> {}: {} at {} fps ({} s), {} matched times", counted(motions->size(), "motion"),
      context.output, counted(blended->clip.frame_count(), "frame"), readable(blended->clip.rate),
      readable(blended->clip.duration(), 4), moments->moments()));
  return kExitDone;
}

}  // namespace krok::cli::blend
