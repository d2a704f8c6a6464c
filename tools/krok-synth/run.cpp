#include "tools/krok-synth/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/io/open_motion.h"
#include "formats/steps/steps.h"
#include "math/transform.h"
#include "parametric/synthesise.h"
#include "roles/roles.h"
#include "tools/cli/output_set.h"
#include "tools/krok-synth/asked_parameters.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"

namespace krok::cli::synth {

namespace {

constexpr int kPlantings = 4;     // attempts to meet what is asked with planted feet
constexpr int kAttempts = 6;      // to come to a place
constexpr double kPlaced = 1e-4;  // metres from it that are near enough
constexpr int kCorrections = 4;   // two are enough near the library; far outside more are needed

struct Motion {
  std::string path;
  std::vector<double> asked;
  parametric::Synthesis synthesis = {};
  parametric::BlendedMotion::Made made = {};
  std::vector<double> measured = {};  // on the clip
  std::vector<double> keytimes = {};  // of the clip, seconds
  double error = 0;                   // largest difference to what was asked, in tolerances
  std::optional<PlantDrift> drift = {};
};

Result<steps::StepsFile> read_steps(const Options& options, ToolContext& context) {
  const auto file = context.open_input(options.library);
  if (!file) return file.error();
  auto steps = steps::read(file->bytes());
  if (!steps) return std::move(steps).error().in_file(options.library);
  if (!steps->weights) {
    return Error("synth-weights", "the library was not fitted", "krok-fit fits it")
        .in_file(options.library);
  }
  const bool is_left = steps->library.swing == FootSide::left;
  const bool other = (options.side == SideChoice::left && !is_left) ||
                     (options.side == SideChoice::right && is_left);
  if (!other) return steps;
  auto mirrored = parametric::mirrored(steps->library);
  if (!mirrored) return std::move(mirrored).error().in_file(options.library);
  steps->library = *std::move(mirrored);
  return steps;
}

// "steps/step_12.anim" for number 12 of "steps/step.anim", zero-padded to the width of the last.
std::string numbered(const std::string& path, std::size_t number, std::size_t count) {
  const std::filesystem::path whole(path);
  const std::string name = fmt::format("{}_{:0{}}{}", whole.stem().string(), number,
                                       fmt::format("{}", count).size(), whole.extension().string());
  return (whole.parent_path() / name).string();
}

// To where the captures have the ground.
void raise(double height, parametric::BlendedMotion::Made& made) {
  for (Vec3f& position : made.clip.positions) position.y() += static_cast<float>(height);
  for (Contact& contact : made.keys.contacts) contact.place.y() += height;
}

Status make(const parametric::Synthesiser& synthesiser, const Options& options, Motion& motion) {
  const auto blended = synthesiser.motion(motion.synthesis.weights);
  if (!blended) return blended.error();
  auto made = blended->make(options.rate);
  if (!made) return made.error();
  motion.made = *std::move(made);
  motion.keytimes = blended->keytimes();
  const double duration = motion.made.clip.duration();
  for (double& time : motion.keytimes) {
    time = std::min(time * duration / blended->duration(), duration);
  }
  return {};
}

// Measures the motion as if it were captured: what weights promise is not taken for granted.
Status measure(const parametric::Synthesiser& synthesiser, Motion& motion) {
  const parametric::Library& library = synthesiser.library();
  auto measured = parametric::make_example(library, motion.path, motion.made.clip, motion.keytimes);
  if (!measured) return measured.error();
  motion.measured = std::move(measured->parameters);
  motion.error = synthesiser.error_of(motion.asked, motion.measured);
  raise(library.ground, motion.made);
  return {};
}

Status plant_and_measure(const parametric::Synthesiser& synthesiser, Motion& motion,
                         ToolContext& context) {
  const RoleMap roles = parametric::roles_of(synthesiser.library());
  const auto drift = plant_result(motion.made.clip, motion.made.keys, roles, context);
  if (!drift) return drift.error();
  motion.drift = *drift;
  return measure(synthesiser, motion);
}

// Plants the feet. Feet that drifted end up elsewhere, by millimetres: what is asked of the library
// is moved by the difference.
Status plant(const parametric::Synthesiser& synthesiser, const Options& options,
             const parametric::SynthesisOptions& how, Motion& motion, ToolContext& context) {
  if (Status status = plant_and_measure(synthesiser, motion, context); !status) return status;
  std::vector<double> aim = motion.asked;
  for (int i = 0; i < kPlantings && motion.error > 1; ++i) {
    for (std::size_t d = 0; d < aim.size(); ++d) aim[d] += motion.asked[d] - motion.measured[d];
    Motion again{.path = motion.path, .asked = motion.asked};
    auto synthesis = synthesiser.weights(aim, how);
    if (!synthesis) break;
    again.synthesis = *std::move(synthesis);
    Status status = make(synthesiser, options, again);
    if (status) status = plant_and_measure(synthesiser, again, context);
    if (!status || again.error >= motion.error) break;
    motion = std::move(again);
  }
  return {};
}

Status make_all(const parametric::Synthesiser& synthesiser, const Options& options,
                std::vector<Motion>& motions, ToolContext& context) {
  parametric::SynthesisOptions how;
  how.extrapolate = options.extrapolate;
  how.corrections = options.correct ? kCorrections : 0;
  std::vector<Status> done(motions.size());
  context.progress->begin("making motions", motions.size());
  parallel_for(motions.size(), 1, context.jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto synthesis = synthesiser.weights(motions[i].asked, how);
      if (!synthesis) {
        done[i] = synthesis.error();
        continue;
      }
      motions[i].synthesis = *std::move(synthesis);
      done[i] = make(synthesiser, options, motions[i]);
      if (done[i] && !options.plant) done[i] = measure(synthesiser, motions[i]);
      context.progress->advance(1);
    }
  });
  context.progress->end();
  // One by one: planting reports warnings.
  for (std::size_t i = 0; options.plant && i < motions.size(); ++i) {
    if (done[i]) done[i] = plant(synthesiser, options, how, motions[i], context);
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (done[i]) continue;
    Error error = std::move(done[i]).error();
    if (motions.size() > 1) error.message = fmt::format("row {}: {}", i + 1, error.message);
    if (error.code == "parametric-bounds" || error.code == "parametric-extrapolation") {
      error.hint += "; --extrapolate allows this";
    }
    return error;
  }
  return {};
}

// What comes before the motions, and how they are put behind it.
struct Before {
  Clip clip;
  MotionKeys keys;
};

Result<Before> read_before(const Options& options, const parametric::Library& library,
                           ToolContext& context) {
  auto clip = io::open_motion(options.after, context);
  if (!clip) return clip.error();
  if (Status status = parametric::same_skeleton(library.skeleton, clip->skeleton); !status) {
    Error error = std::move(status).error();
    error.hint = "krok-retarget transfers a motion to the library's skeleton";
    return std::move(error).in_file(options.after);
  }
  const io::FindRoles find_roles = [&](const Skeleton&) -> Result<RoleMap> {
    return parametric::roles_of(library);
  };
  auto keys = choose_keys(KeysChoice::automatic, options.after, base_name(options.after), *clip,
                          find_roles, context);
  if (!keys) return keys.error();
  return Before{std::move(*clip), keys->value_or(MotionKeys())};
}

// All motions as one, behind `before` (may be null), with planted feet where that is asked for.
Result<Sequence> sequence_of(const Options& options, const parametric::Library& library,
                             const Before* before, const std::vector<Motion>& motions,
                             std::optional<PlantDrift>& drift, ToolContext& context) {
  std::vector<SequencePart> parts;
  if (before) parts.push_back({options.after, &before->clip, &before->keys});
  for (const Motion& motion : motions) {
    parts.push_back({motion.path, &motion.made.clip, &motion.made.keys});
  }
  const RoleMap roles = parametric::roles_of(library);
  auto made = in_sequence(parts, options.transition, roles, context);
  if (!made || !options.plant) return made;
  auto planted = plant_result(made->clip, made->keys, roles, context);
  if (!planted) return planted.error();
  drift = *planted;
  return made;
}

Result<PointMiss> miss_in(const parametric::Library& library, const Sequence& whole,
                          const Motion& last, const Vec3& place) {
  const auto point = measured_point(library);
  if (!point) return point.error();
  const double time = whole.starts.back() + last.keytimes[static_cast<std::size_t>(point->keytime)];
  return miss_of(library, *point, whole.clip, time, place);
}

// Finds the parameters with which the measured point comes to the place where the sequence leads;
// each attempt is measured on the whole.
Status aim_at_place(const parametric::Synthesiser& synthesiser, const Options& options,
                    const Before& before, Motion& motion, ToolContext& context) {
  const parametric::Library& library = synthesiser.library();
  const auto point = measured_point(library);
  if (!point) return point.error();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::optional<PlantDrift> drift;
    const auto made = sequence_of(options, library, &before, {motion}, drift, context);
    if (!made) return made.error();
    const auto miss = miss_in(library, *made, motion, *options.place);
    if (!miss) return miss.error();
    if ((miss->at - *options.place).norm() < kPlaced) break;
    for (std::size_t i = 0; i < 3; ++i) motion.asked[point->parameters[i]] += miss->change[i];
    std::vector<Motion> one = {std::move(motion)};
    if (Status status = make_all(synthesiser, options, one, context); !status) return status;
    motion = std::move(one.front());
  }
  return {};
}

// One motion of all, with what it is in the report.
Result<Sequence> join_all(const parametric::Synthesiser& synthesiser, const Options& options,
                          std::vector<Motion>& motions, ToolContext& context) {
  const parametric::Library& library = synthesiser.library();
  std::optional<Before> before;
  Json report;
  if (!options.after.empty()) {
    auto read = read_before(options, library, context);
    if (!read) return read.error();
    before = *std::move(read);
  }
  if (options.place) {
    Status status = aim_at_place(synthesiser, options, *before, motions.front(), context);
    if (!status) return status.error();
  }
  std::optional<PlantDrift> drift;
  auto made = sequence_of(options, library, before ? &*before : nullptr, motions, drift, context);
  if (!made) return made;
  report["starts"] = made->starts;
  report["duration"] = made->clip.duration();
  if (drift) report["planted"] = to_json(*drift);
  if (options.place) {
    const auto miss = miss_in(library, *made, motions.front(), *options.place);
    if (!miss) return miss.error();
    const double missed = (miss->at - *options.place).norm();
    report["missed"] = missed;
    context.log(fmt::format("the place is missed by {} mm", readable(1e3 * missed, 3)));
  }
  context.report.result["sequence"] = std::move(report);
  return made;
}

Status write_all(const Options& options, std::vector<Motion>& motions, ToolContext& context) {
  OutputSet outputs(context);
  for (Motion& motion : motions) {
    Clip& clip = motion.made.clip;
    clip.provenance = context.provenance();
    Status status =
        add_motion(clip, motion.made.keys, options.orientation, motion.path, context.jobs, outputs);
    if (!status) return status;
  }
  return outputs.finish();
}

std::string with_unit(double value, std::string_view unit) {
  if (unit == "rad") return fmt::format("{}\u00B0", readable(value / kRadiansPerDegree, 4));
  return fmt::format("{} {}", readable(value, 4), unit);
}

// Warns of motions that are not what was asked for; how many there are.
int warn_of_misses(const parametric::Library& library,
                   const std::vector<NamedParameter>& parameters,
                   const std::vector<Motion>& motions, const Options& options,
                   ToolContext& context) {
  int misses = 0;
  for (const Motion& motion : motions) {
    if (!(motion.error > 1)) continue;
    ++misses;
    std::string text;
    for (std::size_t d = 0; d < parameters.size(); ++d) {
      const double off = motion.measured[d] - motion.asked[d];
      const double tolerance = library.parameters[d].tolerance;
      if (std::abs(off) <= tolerance) continue;
      text += fmt::format("{}{} is {}, {} was asked for (tolerance {})", text.empty() ? "" : "; ",
                          parameters[d].name, with_unit(motion.measured[d], parameters[d].unit),
                          with_unit(motion.asked[d], parameters[d].unit),
                          with_unit(tolerance, parameters[d].unit));
    }
    context.warn("synth-missed", fmt::format("{}: {}", motion.path, text),
                 options.correct ? "the library does not reach this, or a duration was rounded to "
                                   "frames of --rate"
                                 : "use --correct, or refine the library with krok-fit --refine");
  }
  return misses;
}

// Returns a line for each motion.
std::vector<std::string> report(const std::vector<NamedParameter>& parameters,
                                const std::vector<Motion>& motions, bool in_one,
                                ToolContext& context) {
  std::vector<std::string> lines;
  Json list = Json::array();
  for (const Motion& motion : motions) {
    Json entry, asked, measured;
    std::string line =
        fmt::format("{}: {} s", motion.path, readable(motion.made.clip.duration(), 4));
    for (std::size_t d = 0; d < parameters.size(); ++d) {
      asked[parameters[d].name] = reported(motion.asked[d], parameters[d].unit);
      measured[parameters[d].name] = reported(motion.measured[d], parameters[d].unit);
      line += fmt::format(", {} {}", parameters[d].name,
                          with_unit(motion.measured[d], parameters[d].unit));
    }
    entry["output"] = in_one ? context.output : motion.path;
    entry["asked"] = std::move(asked);
    entry["measured"] = std::move(measured);
    entry["error_in_tolerances"] = motion.error;
    entry["error_before_correction"] = motion.synthesis.error_before;
    entry["corrections"] = motion.synthesis.corrections;
    entry["weights"] = motion.synthesis.weights;
    if (motion.drift) {
      entry["planted"] = to_json(*motion.drift);
      line += "; " + text_of(*motion.drift);
    }
    entry["duration"] = motion.made.clip.duration();
    entry["frames"] = motion.made.clip.frame_count();
    list.push_back(std::move(entry));
    lines.push_back(std::move(line));
  }
  context.report.result["motions"] = std::move(list);
  return lines;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto steps = read_steps(options, context);
  if (!steps) return steps.error();
  const auto parameters = parameters_of(*steps);
  std::vector<Motion> motions;
  if (options.table.empty()) {
    std::vector<double> means;
    for (const NamedParameter& parameter : parameters) means.push_back(parameter.mean);
    auto point = options.place ? Result<std::vector<double>>(std::move(means))
                               : parse_settings(options.set, parameters, context);
    if (!point) return point.error();
    motions.push_back({.path = context.output, .asked = *std::move(point)});
  } else {
    const auto points = read_points(options.table, parameters, context);
    if (!points) return points.error();
    for (const auto& point : *points) {
      const std::size_t number = motions.size() + 1;
      const std::string path = options.in_sequence
                                   ? fmt::format("motion {}", number)
                                   : numbered(context.output, number, points->size());
      motions.push_back({.path = path, .asked = point});
    }
  }
  const auto synthesiser = parametric::Synthesiser::create(steps->library, *steps->weights);
  if (!synthesiser) return Error(synthesiser.error()).in_file(options.library);
  if (Status status = make_all(*synthesiser, options, motions, context); !status)
    return status.error();
  std::optional<Sequence> whole;
  if (options.in_sequence || !options.after.empty()) {
    auto made = join_all(*synthesiser, options, motions, context);
    if (!made) return made.error();
    whole = *std::move(made);
  }
  const int misses = warn_of_misses(steps->library, parameters, motions, options, context);
  auto lines = report(parameters, motions, options.in_sequence, context);
  if (whole) {
    lines.push_back(fmt::format("{}: {}, {} s", context.output,
                                counted(std::ssize(whole->starts), "motion"),
                                readable(whole->clip.duration(), 4)));
    motions.resize(1);
    motions[0].path = context.output;
    motions[0].made.clip = std::move(whole->clip);
    motions[0].made.keys = std::move(whole->keys);
  }
  if (Status status = write_all(options, motions, context); !status) return status.error();
  for (const std::string& line : lines) context.log(line);
  return options.strict && misses > 0 ? kExitNo : kExitDone;
}

}  // namespace krok::cli::synth
