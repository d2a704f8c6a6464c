#include "tools/krok-ik/run.h"

#include <fmt/format.h>

#include <deque>
#include <filesystem>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/goals/goals.h"
#include "formats/io/open_motion.h"
#include "formats/limits/limits_format.h"
#include "ik/anatomical_limits.h"
#include "ik/learn_limits.h"
#include "tools/cli/output_kind.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-ik/outcome.h"
#include "tools/shared/role_input.h"

namespace krok::cli::ik {

namespace {

class Run {
 public:
  Run(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<int> run();

 private:
  const Arguments& given() const { return options_.given; }
  Status read_motion();
  Status read_limits();
  Status learn();
  Status read_goals();
  Status open_other(const goals::OtherMotion& other);
  Status add_points();
  Status set_stiffness();
  Result<int> joint_of(const std::string& option, const std::string& name) const;
  Status write(const krok::ik::GoalMotion* made);

  const Options& options_;
  ToolContext& context_;
  Clip clip_;
  io::FindRoles find_roles_;
  RoleMap roles_;
  krok::ik::Limits limits_;
  std::vector<krok::ik::KeyedGoal> goals_;
  std::deque<Clip> others_;  // keep their places
  krok::ik::Options solver_;
};

Status Run::read_motion() {
  auto clip = io::open_motion(given().input, context_);
  if (!clip) return clip.error();
  clip_ = std::move(*clip);
  const auto find = io::open_role_map(given().map, context_);
  if (!find) return find.error();
  find_roles_ = *find;
  auto roles = find_roles_(clip_.skeleton);
  if (!roles) return roles.error();
  roles_ = std::move(*roles);
  if (clip_.skeleton.empty()) {
    return Error("ik-empty", "the motion has no joints").in_file(given().input);
  }
  return {};
}

Status Run::learn() {
  std::deque<Clip> clips;
  std::vector<const Clip*> list;
  for (const std::string& path : given().captures) {
    auto clip = io::open_motion(path, context_);
    if (!clip) return clip.error();
    clips.push_back(std::move(*clip));
    list.push_back(&clips.back());
  }
  auto limits = krok::ik::learn_limits(clip_.skeleton, list, {.margin = options_.margin});
  if (!limits) return std::move(limits).error().in_file(given().captures.front());
  limits_ = std::move(*limits);
  return {};
}

Status Run::read_limits() {
  if (!given().captures.empty()) return learn();
  if (given().limits.empty()) return {};
  if (given().limits == "auto") {
    if (!roles_.humanoid) {
      return Error("ik-roles", "--limits auto needs a humanoid; the motion's joints are not one's",
                   "krok-info -v lists the joints and their roles; --map assigns roles")
          .in_file(given().input);
    }
    limits_ = krok::ik::anatomical_limits(clip_.skeleton, roles_);
    return {};
  }
  const auto file = context_.open_input(given().limits);
  if (!file) return file.error();
  auto limits = limits::read(file->text(), clip_.skeleton);
  if (!limits) return std::move(limits).error().in_file(given().limits);
  limits_ = std::move(*limits);
  return {};
}

Result<int> Run::joint_of(const std::string& option, const std::string& name) const {
  const int joint = goals::find_joint(name, clip_.skeleton, roles_);
  if (joint >= 0) return joint;
  return Error("ik-joint",
               fmt::format("{} {}: the motion has no joint of that name or role", option,
                           shown(name)),
               nearest_hint(name, clip_.skeleton.names))
      .in_file(given().input);
}

Status Run::open_other(const goals::OtherMotion& other) {
  const std::string folder = std::filesystem::path(given().goals).parent_path().string();
  auto clip = io::open_motion(below(folder, other.path), context_);
  if (!clip) return clip.error();
  const auto roles = find_roles(clip->skeleton);
  const int joint = goals::find_joint(other.joint, clip->skeleton, roles);
  if (joint < 0) {
    Error error("goals-joint",
                fmt::format("'{}' has no joint '{}', nor one of that role", shown(other.path),
                            shown(other.joint)),
                nearest_hint(other.joint, clip->skeleton.names));
    error.where = other.where;
    return std::move(error).in_file(given().goals);
  }
  others_.push_back(std::move(*clip));
  goals_[other.goal].motion = &others_.back();
  goals_[other.goal].relative_to = joint;
  return {};
}

Status Run::read_goals() {
  if (given().goals.empty()) return {};
  const auto file = context_.open_input(given().goals);
  if (!file) return file.error();
  auto read = goals::read(file->text(), clip_.skeleton, roles_);
  if (!read) return std::move(read).error().in_file(given().goals);
  goals_ = std::move(read->goals);
  solver_.stiffness = std::move(read->stiffness);
  solver_.root_moves = solver_.root_moves || read->root_moves;
  for (const goals::OtherMotion& other : read->others) {
    if (Status status = open_other(other); !status) return status;
  }
  return {};
}

Status Run::add_points() {
  for (const PointGoal& point : options_.points) {
    const auto joint = joint_of(point.option, point.joint);
    if (!joint) return joint.error();
    krok::ik::KeyedGoal goal;
    goal.name = clip_.skeleton.names[at(*joint)];
    goal.goal.kind = point.kind;
    goal.goal.joint = *joint;
    goal.goal.axis = goals::facing_axis(*joint, clip_.skeleton);
    goal.goal.depth = goals::default_depth(*joint, clip_.skeleton, roles_);
    krok::ik::GoalKey key;
    key.target = point.target;
    const double unit = point.in_frames ? 1 / clip_.rate : 1;
    key.time = point.from * unit;
    goal.from = key.time;
    goal.to = point.to * unit;
    goal.fade_in = goal.fade_out = options_.fade;
    goal.keys.push_back(key);
    goals_.push_back(std::move(goal));
  }
  if (given().depth) {
    for (krok::ik::KeyedGoal& goal : goals_) goal.goal.depth = *given().depth;
  }
  return {};
}

Status Run::set_stiffness() {
  if (!options_.stiffness.empty()) solver_.stiffness.resize(clip_.skeleton.names.size(), 0.0);
  for (const Stiffness& stiffness : options_.stiffness) {
    const auto joint = joint_of("--stiffness", stiffness.joint);
    if (!joint) return joint.error();
    // A role that many joints have, such as spine, means them all.
    const auto role = parse_role(stiffness.joint);
    const bool by_role = role && clip_.skeleton.find(stiffness.joint) < 0;
    for (const int j : by_role ? roles_.joints(*role) : std::vector<int>{*joint}) {
      solver_.stiffness[at(j)] = stiffness.value;
    }
  }
  const krok::ik::BodyMasses body = krok::ik::body_masses(clip_.skeleton, roles_);
  solver_.masses = body.masses;
  solver_.mass_centres = body.centres;
  for (const krok::ik::KeyedGoal& goal : goals_) {
    if (goal.goal.kind == krok::ik::Goal::Kind::balance && !roles_.humanoid) {
      return Error(
                 "ik-roles",
                 fmt::format("goal '{}' balances a body that is not a humanoid", shown(goal.name)),
                 "krok-info -v lists the joints and their roles; --map assigns roles")
          .in_file(given().goals);
    }
  }
  return {};
}

Status Run::write(const krok::ik::GoalMotion* made) {
  OutputSet outputs(context_);
  if (!given().write_limits.empty()) {
    const std::string text = limits::write(limits_, clip_.skeleton);
    if (Status status = outputs.add(
            given().write_limits,
            [&](OutputFile& file) { return file.write(std::as_bytes(std::span(text))); });
        !status) {
      return status;
    }
  }
  if (made != nullptr) {
    anim::WriteOptions writing;
    writing.orientation = given().orientation;
    writing.jobs = context_.jobs;
    if (Status status =
            outputs.add(context_.output,
                        [&](OutputFile& file) { return anim::write(made->clip, writing, file); });
        !status) {
      return status;
    }
  }
  return outputs.finish();
}

Result<int> Run::run() {
  if (options_.has_goals() && context_.output.empty()) {
    return Error("usage", "-o is missing", "it names the motion to write");
  }
  if (!options_.has_goals() && !context_.output.empty()) {
    return Error("usage", "-o is given, but no goals", "use --goals, --reach or --look-at");
  }
  if (Status status = check_output_kind(context_.output, "-o", registry::Kind::anim); !status) {
    return status.error();
  }
  solver_ = options_.solver;
  for (const auto step : {&Run::read_motion, &Run::read_limits, &Run::read_goals, &Run::add_points,
                          &Run::set_stiffness}) {
    if (Status status = (this->*step)(); !status) return status.error();
  }
  if (!options_.has_goals()) {
    if (Status status = write(nullptr); !status) return status.error();
    context_.report.result = limits_json(limits_, clip_.skeleton);
    context_.log(fmt::format("{}: {}", given().write_limits, limits_summary(limits_)));
    return kExitDone;
  }
  krok::ik::GoalMotionOptions how;
  how.solver = solver_;
  how.jobs = context_.jobs;
  auto made = krok::ik::apply_goals(clip_, goals_, limits_, how);
  if (!made) {
    return std::move(made).error().in_file(given().goals.empty() ? given().input : given().goals);
  }
  const Outcome outcome{clip_, goals_, limits_, *made};
  for (Diagnostic& missed : missed_goals(outcome)) {
    missed.where.file = given().input;
    context_.diagnose(std::move(missed));
  }
  made->clip.provenance = context_.provenance();
  made->clip.provenance.conversions = clip_.provenance.conversions;
  made->clip.provenance.conversions.push_back("inverse kinematics: " + summary(outcome));
  if (Status status = write(&*made); !status) return status.error();
  context_.report.result = to_json(outcome);
  context_.log(fmt::format("{}: {}", context_.output, summary(outcome)));
  if (context_.verbose) context_.log(table(outcome));
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  return Run(options, context).run();
}

}  // namespace krok::cli::ik
