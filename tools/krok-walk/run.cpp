#include "tools/krok-walk/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/io/inputs.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/path/path_format.h"
#include "formats/prints/prints.h"
#include "formats/registry/registry.h"
#include "formats/steps/steps.h"
#include "gait/path.h"
#include "gait/plan_prints.h"
#include "gait/print.h"
#include "gait/step_library.h"
#include "gait/walk.h"
#include "motion/hips_root.h"
#include "nodes/evaluate.h"
#include "roles/roles.h"
#include "terrain/terrain.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::walk {

namespace {

constexpr double kRate = 60;           // places per second
constexpr double kMaxPlaces = 1e6;     // of a node
constexpr double kMinTravel = 0.05;    // metres from the first place
constexpr double kStrideWindow = 1.1;  // seconds, see gait::way_of()

// The places of all nodes: a clip of joints without parents.
Clip places_of(const nodes::Scene& scene, const nodes::Evaluator& evaluator) {
  Clip clip;
  for (const nodes::Node& node : scene.nodes) {
    clip.skeleton.add(node.name, Skeleton::kNoParent, {});
  }
  const std::vector<double> times = evaluator.key_times(0);
  const double length = times.empty() ? 0 : times.back() - times.front();
  clip.rate = std::min(kRate, kMaxPlaces / std::max(length * double(scene.nodes.size()), 1e-9));
  clip.resize(static_cast<int>(std::floor(length * clip.rate)) + 2);
  nodes::Evaluation state;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double time = times.empty() ? 0 : std::min(times.front() + f / clip.rate, times.back());
    evaluator.place_nodes(0, time, state);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
      clip.frame_positions(f)[n] = state.node_to_world[n].block<3, 1>(0, 3).cast<float>();
    }
  }
  return clip;
}

bool goes_anywhere(const Clip& clip, int node) {
  const Vec3f from = clip.frame_positions(0)[at(node)];
  for (int f = 1; f < clip.frame_count(); ++f) {
    const Vec3f way = clip.frame_positions(f)[at(node)] - from;
    if (std::hypot(way.x(), way.z()) > kMinTravel) return true;
  }
  return false;
}

// The way over the ground of an animated node of a glTF file, or of another scene, in its first
// animation. Without a name, of the first node that goes anywhere. Joints of skins sway with steps,
// which is taken out. Codes: those of reading the scene; path-node if there is no such node, or it
// stays where it is.
Result<std::vector<gait::PathPoint>> way_of_node(const InputFile& file, const std::string& name,
                                                 io::Inputs& inputs) {
  auto scene = io::open_scene(file, inputs);
  if (!scene) return std::move(scene).error();
  const auto fail = [&](std::string message, const char* hint) {
    return Error("path-node", std::move(message), hint).in_file(file.path());
  };
  if (scene->animations.empty()) {
    return fail("nothing is animated, so that no node has a way",
                "animate the node that goes ahead");
  }
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return Error(evaluator.error()).in_file(file.path());
  const Clip clip = places_of(*scene, *evaluator);
  int found = -1;
  for (int node = 0; node < clip.joint_count() && found < 0; ++node) {
    const bool named = clip.skeleton.names[at(node)] == name;
    if (name.empty() ? goes_anywhere(clip, node) : named) found = node;
  }
  if (found < 0 && !name.empty()) {
    return fail(fmt::format("no node is called '{}'", shown(name)), "krok-info lists the nodes");
  }
  if (found < 0 || !goes_anywhere(clip, found)) {
    return fail(
        found < 0 ? "no node goes anywhere" : fmt::format("'{}' stays where it is", shown(name)),
        "name an animated node with --path-id");
  }
  const bool sways = std::ranges::any_of(scene->skins, [&](const nodes::Skin& skin) {
    return std::ranges::find(skin.joints, found) != skin.joints.end();
  });
  return gait::way_of(clip, found, sways ? kStrideWindow : 0);
}

Result<std::vector<gait::PathPoint>> read_way(const Options& options, ToolContext& context) {
  const auto file = context.open_input(options.path);
  if (!file) return file.error();
  const registry::Kind kind = registry::kind_of_content(file->bytes());
  if (kind == registry::Kind::unknown) {
    return path_file::read(file->text(), options.path, {options.path_scale, options.path_id});
  }
  if (io::is_scene(kind)) return way_of_node(*file, options.path_id, context);
  const auto clip = io::open_motion(*file, context);
  if (!clip) return clip.error();
  if (options.path_id.empty()) {
    return gait::way_of(*clip, carrying_joint(find_roles(clip->skeleton)));
  }
  const int joint = clip->skeleton.find(options.path_id);
  if (joint < 0) {
    return Error("path-node", fmt::format("no joint is called '{}'", shown(options.path_id)),
                 "krok-info lists the joints")
        .in_file(options.path);
  }
  return gait::way_of(*clip, joint);
}

Result<gait::Path> make_path(const Options& options, bool backward, ToolContext& context) {
  if (options.path.empty()) {
    const auto [x, z, heading] = options.from;
    return gait::Path::create(
        gait::way_to_goals(x, z, heading + (backward ? kPi : 0), options.goals));
  }
  const auto way = read_way(options, context);
  if (!way) return way.error();
  auto path = gait::Path::create(*way);
  if (!path) return std::move(path.error()).in_file(options.path);
  constexpr double kShort = 0.5, kLong = 300;  // metres: less than a step; a walk of minutes
  if (path->length() > kLong && extension(options.path) == ".csv") {
    context.diagnose_in(
        options.path,
        {make_warning("path-long",
                      fmt::format("the path is {} m long", readable(path->length(), 3)),
                      "columns without a unit are metres; centimetres are x [cm], z [cm]")});
  }
  if (path->length() < kShort && extension(options.path) == ".svg") {
    context.diagnose_in(
        options.path,
        {make_warning("path-short",
                      fmt::format("the path is {} m long", readable(path->length(), 3)),
                      "--path-scale LENGTH is the length of a unit of the drawing, such as 1m; 1cm "
                      "without it")});
  }
  return path;
}

// The footprints to walk on: those of a file, or planned along a way or to goals.
Result<std::vector<gait::Print>> choose_prints(const Options& options,
                                               std::span<const gait::StepLibrary> libraries,
                                               const Terrain& ground, ToolContext& context) {
  if (!options.prints.empty()) {
    const auto file = context.open_input(options.prints);
    if (!file) return file.error();
    return prints::read(file->text(), options.prints);
  }
  auto usual = gait::usual_steps(libraries);
  if (!usual) return usual.error();
  const auto path = make_path(options, usual->backward, context);
  if (!path) return path.error();
  gait::PlanOptions& plan = *usual;
  plan.first = options.first;
  if (options.step_width) plan.step_width = *options.step_width;
  if (options.step_length) {
    plan.step_length = *options.step_length;
    plan.max_step = std::max(plan.max_step, plan.step_length);
    plan.min_step = std::min(plan.min_step, plan.step_length);
  }
  for (const double speed : options.pace) {
    const auto length = gait::step_length_at_speed(libraries, speed / options.speed);
    if (!length) return length.error();
    plan.step_lengths.push_back(*length);
    plan.max_step = std::max(plan.max_step, *length);
    plan.min_step = std::min(plan.min_step, *length);
  }
  const auto planned = gait::plan_prints(*path, ground, plan);
  if (!planned) return Error(planned.error()).in_file(options.path);
  context.report.result["way"] = {{"length", path->length()},
                                  {"step_length", plan.step_length},
                                  {"step_width", plan.step_width},
                                  {"fitted_to_ground", planned->fitted_to_ground}};
  return planned->prints;
}

// Says that steps of several styles are mixed.
void mention_styles(std::span<const gait::StepLibrary> libraries, ToolContext& context) {
  std::vector<std::string> styles;
  for (const gait::StepLibrary& library : libraries) {
    for (const parametric::Example& example : library.library().examples) {
      if (!example.style.empty()) styles.push_back(example.style);
    }
  }
  std::ranges::sort(styles);
  styles.erase(std::unique(styles.begin(), styles.end()), styles.end());
  if (styles.size() < 2) return;
  constexpr std::size_t kShown = 8;
  const std::size_t count = styles.size();
  styles.resize(std::min(kShown, count));
  for (std::string& style : styles) style = shown(style);
  context.log(fmt::format("steps of {} styles are mixed ({}{}); --style NAME walks in one", count,
                          fmt::join(styles, ", "), count > kShown ? ", ..." : ""));
}

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
  if (!options.style.empty()) {
    if (Status status = gait::take_style(libraries, options.style); !status) return status.error();
  } else {
    mention_styles(libraries, context);
  }
  return libraries;
}

// Prints in files are in another folder than their numbers in messages.
Error with_hint(Error error, const Options& options) {
  if (error.code.starts_with("walk-") && !options.prints.empty()) {
    error = std::move(error).in_file(options.prints);
  }
  constexpr std::string_view kAdapt = ", or use --adapt";
  if (const auto place = error.hint.find(kAdapt); options.adapt && place != std::string::npos) {
    error.hint.erase(place, kAdapt.size());  // it was
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

// Along the ground while a foot stands, metres per second: half of the way of the other foot.
double speed_of(const gait::StepReport& step, const std::vector<gait::GroundedPrint>& prints) {
  const Vec3 way = prints[at(step.stance) + 1].heel - prints[at(step.stance) - 1].heel;
  return std::hypot(way.x(), way.z()) / 2 / std::max(step.end - step.start, 1e-9);
}

// Warns of a pace that the steps nearest to its place do not go at: the mean of three, as they
// begin and end a walk standing. Returns the number of them.
int check_pace(const Options& options, const std::vector<double>& speeds, ToolContext& context) {
  constexpr double kTolerance = 0.1;  // of the pace
  const int count = static_cast<int>(speeds.size());
  int missed = 0;
  for (std::size_t p = 0; p < options.pace.size() && count > 0; ++p) {
    const double part =
        options.pace.size() < 2 ? 0.5 : static_cast<double>(p) / double(options.pace.size() - 1);
    const int middle = std::clamp(static_cast<int>(std::lround(part * (count - 1))),
                                  std::min(2, count / 2), std::max(count - 3, count / 2));
    const int first = std::max(middle - 1, 0), end = std::min(middle + 2, count);
    double speed = 0;
    for (int i = first; i < end; ++i) speed += speeds[at(i)] / (end - first);
    // The pace changes on the way to the next.
    const double along = (middle + 0.5) / count * double(options.pace.size() - 1);
    const std::size_t before = std::min(static_cast<std::size_t>(along), options.pace.size() - 1);
    const std::size_t after = std::min(before + 1, options.pace.size() - 1);
    const double asked = options.pace[before] +
                         (along - double(before)) * (options.pace[after] - options.pace[before]);
    if (std::abs(speed - asked) <= kTolerance * asked) continue;
    ++missed;
    context.warn(
        "walk-pace",
        fmt::format("--pace asks for {} m/s, the steps there go at {} m/s", readable(asked, 3),
                    readable(speed, 3)),
        count < 10
            ? "it takes some steps to get up to speed: give a longer way"
            : "give examples of this speed, or --speed; in curves and on slopes steps are shorter");
  }
  return missed;
}

void report_steps(const Options& options, std::span<const gait::StepLibrary> libraries,
                  const gait::WalkDetails& details, ToolContext& context) {
  Json steps = Json::array();
  std::vector<double> speeds;
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
    if (!step.example.empty()) entry["style_of"] = step.example;
    const auto library = std::ranges::find(libraries, step.library, &gait::StepLibrary::name);
    if (library != libraries.end()) {
      entry["asked"] = parameters_json(library->library(), step.asked);
      entry["made"] = parameters_json(library->library(), step.made);
    }
    speeds.push_back(speed_of(step, details.prints));
    entry["speed"] = speeds.back();
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
  result["largest_speed"] = speeds.empty() ? 0 : std::ranges::max(speeds);
  result["steps"] = std::move(steps);
  result["missed_paces"] = check_pace(options, speeds, context);
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
    report_steps(options, libraries, details, context);
    return context.provenance();
  };
  Status status = outputs.add(context.output, [&](OutputFile& file) {
    return anim::write(frames, provenance,
                       {.orientation = options.orientation, .jobs = thread_count(context.jobs)},
                       file);
  });
  if (!status) return status;
  status = add_keys(details.keys, frames.skeleton, frames.duration(), context.output, outputs);
  if (!status) return status;
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

void report_walk(const FrameSource& frames, const std::vector<gait::Print>& prints, double speed,
                 ToolContext& context) {
  Json& result = context.report.result;
  result["prints"] = prints.size();
  result["frames"] = frames.frame_count;
  result["duration"] = frames.duration();
  const double missed = 1000 * result["largest_miss"].get<double>();
  context.log(fmt::format(
      "{}: {}, {} s, at up to {} m/s{}; feet miss their prints by {} mm, swing {} cm over "
      "the ground or more",
      context.output, counted(prints.size() - 2, "step"), readable(frames.duration(), 4),
      readable(result["largest_speed"].get<double>(), 2),
      speed == 1 ? std::string() : fmt::format(" ({} times the library's speed)", readable(speed)),
      missed < 0.001 ? "less than 0.001" : readable(missed, 2),
      readable(100 * result["min_clearance"].get<double>(), 3)));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto libraries = open_libraries(options, context);
  if (!libraries) return libraries.error();
  const auto ground = options.ground.open(context);
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
  how.variation = options.variation;
  how.seed = options.seed;
  const auto walk = gait::Walk::plan(*libraries, *prints, **ground, how);
  if (!walk) return with_hint(walk.error(), options);
  if (Status status = write_all(options, *walk, *prints, **ground, *libraries, context); !status) {
    return status.error();
  }
  report_walk(walk->frames(), *prints, options.speed, context);
  const bool as_asked =
      walk->details().warnings.empty() && context.report.result["missed_paces"] == 0;
  return options.strict && !as_asked ? kExitNo : kExitDone;
}

}  // namespace krok::cli::walk
