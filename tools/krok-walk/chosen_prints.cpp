#include "tools/krok-walk/chosen_prints.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/path/path_format.h"
#include "formats/prints/prints.h"
#include "formats/registry/registry.h"
#include "gait/plan_prints.h"
#include "gait/usual_step.h"
#include "motion/ground_frame.h"
#include "roles/roles.h"
#include "tools/krok-walk/node_way.h"

namespace krok::cli::walk {

namespace {

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
    const double heading = options.heading + (backward ? kPi : 0);
    return gait::Path::create(
        gait::way_to_goals(options.from.x(), options.from.y(), heading, options.goals));
  }
  const auto way = read_way(options, context);
  if (!way) return way.error();
  auto path = gait::Path::create(*way);
  if (!path) return std::move(path.error()).in_file(options.path);
  return path;
}

}  // namespace

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
  const auto planned = gait::plan_prints(*path, ground, plan);
  if (!planned) return Error(planned.error()).in_file(options.path);
  context.report.result["way"] = {{"length", path->length()},
                                  {"step_length", plan.step_length},
                                  {"step_width", plan.step_width},
                                  {"fitted_to_ground", planned->fitted_to_ground}};
  return planned->prints;
}

}  // namespace krok::cli::walk
