#include "tools/krok-walk/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/anim/anim.h"
#include "formats/io/open_role_map.h"
#include "formats/io/open_terrain.h"
#include "formats/keys/keys.h"
#include "formats/prints/prints.h"
#include "formats/steps/steps.h"
#include "gait/walk.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_kind.h"
#include "tools/cli/output_set.h"
#include "tools/krok-walk/chosen_prints.h"
#include "tools/shared/keys_choice.h"
#include "tools/shared/walk_page.h"

namespace krok::cli::walk {

namespace {

Result<std::vector<gait::StepLibrary>> open_libraries(const Options& options,
                                                      ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::vector<gait::StepLibrary> libraries;
  for (const std::string& path : options.libraries) {
    const auto file = context.open_input(path);
    if (!file) return file.error();
    auto steps = steps::read(file->bytes());
    if (!steps) return std::move(steps).error().in_file(path);
    if (!steps->weights) {
      return Error("walk-library", "the library was not fitted", "krok-fit fits it").in_file(path);
    }
    if (!options.map.empty()) {
      const auto roles = (*find_roles)(steps->library.skeleton);
      if (!roles) return roles.error();
      steps->library.given_roles = parametric::given_roles(*roles);
    }
    const RoleMap roles = parametric::roles_of(steps->library);
    auto library = gait::StepLibrary::create(name_of_input(path), std::move(steps->library),
                                             *steps->weights, roles);
    if (!library) return std::move(library).error().in_file(path);
    libraries.push_back(*std::move(library));
  }
  return libraries;
}

// Prints in files are in another folder than their numbers in messages.
Error with_hint(Error error, const Options& options) {
  if (error.code.starts_with("walk-") && !options.prints.empty()) {
    error = std::move(error).in_file(options.prints);
  }
  if (error.code == "walk-outside" && error.hint.find("--extrapolate") == std::string::npos) {
    error.hint += ", or --extrapolate";
  }
  return error;
}

Json parameters_json(const parametric::Library& library, std::span<const double> values) {
  Json object = Json::object();
  for (std::size_t d = 0; d < values.size(); ++d) {
    object[parametric::name_of(library.parameters[d], library.skeleton, library.keytimes)] =
        reported(values[d], unit_of(library.parameters[d]));
  }
  return object;
}

void report_steps(std::span<const gait::StepLibrary> libraries, const gait::WalkDetails& details,
                  ToolContext& context) {
  Json steps = Json::array();
  double missed = 0, clearance = 1e9, lowered = 0, extension = 0;
  int moved = 0;
  for (const gait::StepReport& step : details.steps) {
    Json entry = Json::object();
    entry["from_print"] = step.stance;  // counted from 1: the one before the stance print
    entry["stance_print"] = step.stance + 1;
    entry["to_print"] = step.stance + 2;
    entry["start"] = step.start;
    entry["end"] = step.end;
    entry["library"] = step.library;
    const auto library = std::ranges::find(libraries, step.library, &gait::StepLibrary::name);
    if (library != libraries.end()) {
      entry["asked"] = parameters_json(library->library(), step.asked);
      entry["made"] = parameters_json(library->library(), step.made);
    }
    entry["missed"] = step.missed;
    entry["moved"] = step.moved;
    if (!step.why_moved.empty()) entry["why_moved"] = step.why_moved;
    entry["clearance"] = step.clearance;
    entry["leg_extension"] = step.leg_extension;
    entry["pelvis_lowered"] = step.pelvis_lowered;
    steps.push_back(std::move(entry));
    missed = std::max(missed, step.missed);
    clearance = std::min(clearance, step.clearance);
    lowered = std::max(lowered, step.pelvis_lowered);
    extension = std::max(extension, step.leg_extension);
    if (step.moved <= 0) continue;
    ++moved;
    context.warn("walk-moved", fmt::format("print {} was moved by {} m: {}", step.stance + 2,
                                           readable(step.moved, 3), step.why_moved));
  }
  Json& result = context.report.result;
  result["largest_miss"] = missed;
  result["min_clearance"] = clearance;
  result["largest_leg_extension"] = extension;
  result["largest_pelvis_lowering"] = lowered;
  result["moved_prints"] = moved;
  result["steps"] = std::move(steps);
}

// The prints as walked: those that `adapt` moved are where they were moved to.
std::vector<gait::Print> walked_prints(std::vector<gait::Print> prints,
                                       const gait::WalkDetails& details) {
  for (const gait::StepReport& step : details.steps) {
    const auto index = static_cast<std::size_t>(step.stance) + 1;
    if (step.moved <= 0 || index >= prints.size()) continue;
    const gait::GroundedPrint& set = details.prints[index];
    prints[index].x = set.heel.x();
    prints[index].z = set.heel.z();
    prints[index].heading = set.heading;
  }
  return prints;
}

Status write_all(const Options& options, const gait::Walk& walk,
                 const std::vector<gait::Print>& prints, const Terrain& ground,
                 std::span<const gait::StepLibrary> libraries, ToolContext& context) {
  OutputSet outputs(context);
  const FrameSource& frames = walk.frames();
  gait::WalkDetails details;
  // What is known only after all frames were made goes into the file's provenance: the warnings.
  const auto provenance = [&] {
    details = walk.details();
    context.diagnose(details.warnings);
    report_steps(libraries, details, context);
    return context.provenance();
  };
  Status status = outputs.add(context.output, [&](OutputFile& file) {
    return anim::write(frames, provenance,
                       {.orientation = options.orientation, .jobs = thread_count(context.jobs)},
                       file);
  });
  if (!status) return status;
  const auto keys_path = place_for_keys(details.keys, context.output);
  if (!keys_path) return keys_path.error();
  if (!keys_path->empty()) {
    status = outputs.add(*keys_path, [&](OutputFile& file) {
      return file.write(keys::write(details.keys, frames.skeleton, frames.duration()));
    });
    if (!status) return status;
  }
  const auto write =
      extension(options.save_prints) == ".json" ? prints::write_json : prints::write_csv;
  status = outputs.add(options.save_prints, [&](OutputFile& file) {
    return write(walked_prints(prints, details), file);
  });
  if (!status) return status;
  status = outputs.add(options.view, [&](OutputFile& file) -> Status {
    const auto clip = load(frames, thread_count(context.jobs));
    if (!clip) return clip.error();
    const auto page = walk_page(name_of_input(context.output), *clip, details.keys, ground,
                                walked_prints(prints, details), context);
    return page ? file.write(*page) : Status(page.error());
  });
  if (!status) return status;
  return outputs.finish();
}

void report_walk(const FrameSource& frames, const std::vector<gait::Print>& prints,
                 ToolContext& context) {
  Json& result = context.report.result;
  result["prints"] = prints.size();
  result["frames"] = frames.frame_count;
  result["duration"] = frames.duration();
  const double missed = 1000 * result["largest_miss"].get<double>();
  context.log(fmt::format(
      "{}: {}, {} s; feet miss their prints by {} mm, swing {} cm over "
      "the ground or more",
      context.output, counted(static_cast<long long>(prints.size()) - 2, "step"),
      readable(frames.duration(), 4), missed < 0.001 ? "less than 0.001" : readable(missed, 2),
      readable(100 * result["min_clearance"].get<double>(), 3)));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (Status status = check_output_kind(context.output, "-o", registry::Kind::anim); !status) {
    return status.error();
  }
  const auto libraries = open_libraries(options, context);
  if (!libraries) return libraries.error();
  const auto ground = io::open_terrain(options.ground, options.placement, context);
  if (!ground) return ground.error();
  const auto prints = choose_prints(options, *libraries, **ground, context);
  if (!prints) return prints.error();
  gait::WalkOptions how;
  how.rate = options.rate;
  how.speed = options.speed;
  how.extrapolate = options.extrapolate;
  how.adapt = options.adapt;
  how.stretch = options.stretch;
  how.clearance = options.clearance;
  const auto walk = gait::Walk::plan(*libraries, *prints, **ground, how);
  if (!walk) return with_hint(walk.error(), options);
  if (Status status = write_all(options, *walk, *prints, **ground, *libraries, context); !status) {
    return status.error();
  }
  report_walk(walk->frames(), *prints, context);
  return kExitDone;
}

}  // namespace krok::cli::walk
