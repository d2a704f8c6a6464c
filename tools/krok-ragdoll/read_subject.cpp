#include "tools/krok-ragdoll/fall.h"
#include "tools/krok-ragdoll/follow.h"

#include <fmt/format.h>

#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/limits/limits_format.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "ik/anatomical_limits.h"
#include "ragdoll/bodies.h"
#include "retarget/stance.h"
#include "skin/bind.h"
#include "tools/cli/paths.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kMinCovered = 0.9;
constexpr double kMaxPlausibleMass = 500;  // kilograms

class SubjectReader {
 public:
  SubjectReader(const Options& options, ToolContext& context)
      : options_(options), context_(context) {}

  Result<Subject> read();

 private:
  Status read_motion();
  Status read_limits();
  Status read_bodies();
  Status read_given_bodies();
  void check_cover(const Model& model);
  Status set_modes();
  Status read_rises();
  Status read_ground();

  const Options& options_;
  ToolContext& context_;
  Subject subject_;
  Skeleton neutral_;  // the motion's, in a pose that angles can be measured from
};

Status SubjectReader::read_motion() {
  auto clip = io::open_motion(options_.input, context_);
  if (!clip) return clip.error();
  subject_.clip = std::move(*clip);
  if (subject_.clip.frame_count() == 0) {
    return Error("ragdoll-time", "the motion has no frames, so that nothing falls")
        .in_file(options_.input);
  }
  const auto find = io::open_role_map(options_.map, context_);
  if (!find) return find.error();
  auto roles = (*find)(subject_.clip.skeleton);
  if (!roles) return roles.error();
  subject_.roles = std::move(*roles);
  neutral_ = retarget::neutral_skeleton(subject_.clip, subject_.roles);
  return {};
}

Status SubjectReader::read_limits() {
  if (options_.limits == "none") return {};
  if (options_.limits == "auto") {
    subject_.limits = krok::ik::anatomical_limits(neutral_, subject_.roles);
    return {};
  }
  const auto file = context_.open_input(options_.limits);
  if (!file) return file.error();
  auto limits = limits::read(file->text(), subject_.clip.skeleton);
  if (!limits) return std::move(limits).error().in_file(options_.limits);
  subject_.limits = std::move(*limits);
  return {};
}

Status SubjectReader::read_given_bodies() {
  const auto file = context_.open_input(options_.bodies);
  if (!file) return file.error();
  auto read = ragdoll_file::read(file->text(), &subject_.clip.skeleton);
  if (!read) return std::move(read).error().in_file(options_.bodies);
  subject_.bodies = std::move(read->bodies);
  subject_.rules = std::move(read->joints);
  return set_modes();
}

Status SubjectReader::read_bodies() {
  if (!options_.bodies.empty()) return read_given_bodies();
  krok::ragdoll::BodyOptions how;
  how.mass = options_.mass;
  if (how.mass.value_or(0) > kMaxPlausibleMass && subject_.roles.humanoid) {
    context_.warn(
        "ragdoll-mass",
        fmt::format("{} kg is no person's mass: pushes hardly move it", readable(*how.mass)),
        "--mass is in kilograms");
  }
  std::optional<Model> model;
  if (!options_.model.empty()) {
    auto actor =
        io::open_actor(options_.model, context_, {.with_materials = false, .with_motions = false});
    if (!actor) return actor.error();
    if (!actor->motions.empty()) {
      return Error("ragdoll-model", "is a motion, not a model",
                   "krok-body makes a model for a motion")
          .in_file(options_.model);
    }
    model = std::move(actor->model);
    // Files that share joints need not have them in one order; make_bodies() says what else
    // differs.
    if (model->skeleton.names != neutral_.names) {
      if (auto bound = bind_to(*model, neutral_)) model = *std::move(bound);
    }
    how.model = &*model;
  }
  auto bodies = krok::ragdoll::make_bodies(neutral_, subject_.roles, how);
  if (!bodies) {
    const bool of_model = bodies.error().code == "ragdoll-model";
    return std::move(bodies).error().in_file(of_model ? options_.model : options_.input);
  }
  subject_.bodies = std::move(*bodies);
  if (options_.limits == "auto" && !subject_.roles.humanoid) {
    subject_.limits = krok::ragdoll::cone_limits(neutral_, subject_.bodies);
  }
  if (model) check_cover(*model);
  return set_modes();
}

void SubjectReader::check_cover(const Model& model) {
  subject_.covered = krok::ragdoll::covered_share(model, subject_.bodies, kCoverDistance);
  if (*subject_.covered >= kMinCovered) return;
  context_.warn("ragdoll-model",
                fmt::format("{}: {:.0f} % of the vertices are within 3 cm of a body (90 are "
                            "expected)",
                            shown(options_.model), 100 * *subject_.covered),
                "--save-bodies OUT.ragdoll.json, edit the shapes, and give them to --bodies");
}

Status SubjectReader::set_modes() {
  if (options_.follow.powered.value_or(0) > 0 && !subject_.roles.humanoid) {
    return Error("ragdoll-roles",
                 "--powered is for humanoids: motors are as strong as the joints of adults",
                 "krok-info -v lists the joints and their roles; --map assigns roles")
        .in_file(options_.input);
  }
  Status status = ragdoll::set_modes(options_.follow, !options_.rises.empty(),
                                     subject_.clip.skeleton, subject_.roles, subject_.bodies);
  if (status || status.error().code == "usage") return status;
  return Error(status.error()).in_file(options_.input);
}

Status SubjectReader::read_rises() {
  for (const std::string& path : options_.rises) {
    auto clip = io::open_motion(path, context_);
    if (!clip) return clip.error();
    // Checked here, so that the message has the file's name.
    const auto fits = krok::ragdoll::choose_rise(subject_.clip, 0, {&*clip, 1}, subject_.roles,
                                                 subject_.bodies, false);
    if (!fits) return Error(fits.error()).in_file(path);
    subject_.rises.push_back(std::move(*clip));
    subject_.rise_names.push_back(name_of_input(path));
  }
  return {};
}

Status SubjectReader::read_ground() {
  auto terrain = options_.ground.open(context_);
  if (!terrain) return terrain.error();
  subject_.terrain = std::move(*terrain);
  return {};
}

Result<Subject> SubjectReader::read() {
  for (const auto step :
       {&SubjectReader::read_motion, &SubjectReader::read_limits, &SubjectReader::read_bodies,
        &SubjectReader::read_rises, &SubjectReader::read_ground}) {
    if (Status status = (this->*step)(); !status) return status.error();
  }
  return std::move(subject_);
}

}  // namespace

Result<Subject> read_subject(const Options& options, ToolContext& context) {
  return SubjectReader(options, context).read();
}

}  // namespace krok::cli::ragdoll
