#include "tools/krok-ik/run.h"

#include <fmt/format.h>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/goals/goals.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_terrain.h"
#include "formats/limits/limits_format.h"
#include "ik/anatomical_limits.h"
#include "ik/learn_limits.h"
#include "retarget/stance.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_kind.h"
#include "tools/cli/output_set.h"
#include "tools/krok-ik/chart.h"
#include "tools/krok-ik/outcome.h"
#include "tools/shared/goal_input.h"
#include "tools/shared/planting.h"
#include "tools/shared/role_input.h"

namespace krok::cli::ik {

namespace {

class Run {
 public:
  Run(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<int> run();

 private:
  const Arguments& given() const { return options_.given; }
  Status check_outputs() const;
  Status read_motion();
  Status read_limits();
  Status learn();
  Status read_goals();
  Status add_points();
  Status raise_goals();
  Status set_stiffness();
  Status plant_first();
  Result<int> finish_without_goals();
  void note_provenance(Clip& clip, const std::string& line) const;
  Result<int> joint_of(const std::string& option, const std::string& name) const;
  Status write(const Clip* made, const std::string& chart = {});

  const Options& options_;
  ToolContext& context_;
  Clip clip_;
  io::FindRoles find_roles_;
  RoleMap roles_;
  krok::ik::Limits limits_;
  std::vector<krok::ik::KeyedGoal> goals_;
  OpenedGoals opened_;  // goals_ point to its motions
  krok::ik::Options solver_;
  Json planting_;
  std::string planting_line_;
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
    limits_ = krok::ik::anatomical_limits(retarget::neutral_skeleton(clip_, roles_), roles_);
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

Status Run::read_goals() {
  if (given().goals.empty()) return {};
  auto opened = open_goals(given().goals, clip_.skeleton, roles_, context_);
  if (!opened) return opened.error();
  opened_ = std::move(*opened);
  goals_ = opened_.goals;
  solver_.stiffness = opened_.stiffness;
  solver_.root_moves = solver_.root_moves || opened_.root_moves;
  return {};
}

// With --ground heights of goals in the world are over the ground.
Status Run::raise_goals() {
  if (given().ground.empty()) return {};
  const auto ground = io::open_terrain(given().ground, {}, context_);
  if (!ground) return ground.error();
  for (krok::ik::KeyedGoal& goal : goals_) {
    if (goal.relative_to >= 0) continue;
    for (krok::ik::GoalKey& key : goal.keys) {
      const auto point = (*ground)->at(key.target.x(), key.target.z());
      if (!point) {
        return Error("ik-ground",
                     fmt::format("goal {}: there is no ground at x {} m, z {} m", shown(goal.name),
                                 readable(key.target.x(), 4), readable(key.target.z(), 4)),
                     "move the goal, or give a larger ground");
      }
      key.target.y() += point->height;
    }
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

// The goals are for the motion with its feet planted.
Status Run::plant_first() {
  if (!given().plant) return {};
  const auto contacts = read_planting_contacts(given().contacts, given().input, clip_, context_);
  if (!contacts) return contacts.error();
  auto planted = plant(clip_, roles_, *contacts, context_);
  if (!planted) return std::move(planted).error().in_file(given().input);
  planting_ = planting_json(*planted, contacts->has_value());
  planting_line_ = planting_line(*planted);
  clip_ = std::move(planted->clip);
  return {};
}

// What was done to the motion, after what it says of itself.
void Run::note_provenance(Clip& clip, const std::string& line) const {
  clip.provenance = context_.provenance();
  clip.provenance.conversions = clip_.provenance.conversions;
  for (const std::string& done : {planting_line_, line}) {
    if (!done.empty()) clip.provenance.conversions.push_back(done);
  }
}

Result<int> Run::finish_without_goals() {
  if (!given().plant) {
    if (Status status = write(nullptr); !status) return status.error();
    context_.report.result = limits_json(limits_, clip_.skeleton);
    context_.log(fmt::format("{}: {}", given().write_limits, limits_summary(limits_)));
    return kExitDone;
  }
  Clip planted = clip_;
  note_provenance(planted, {});
  if (Status status = write(&planted); !status) return status.error();
  context_.report.result["frames"] = planted.frame_count();
  context_.report.result["plant"] = std::move(planting_);
  context_.log(fmt::format("{}: {}", context_.output, planting_line_));
  return kExitDone;
}

Status Run::write(const Clip* made, const std::string& chart) {
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
    if (Status status = outputs.add(
            context_.output, [&](OutputFile& file) { return anim::write(*made, writing, file); });
        !status) {
      return status;
    }
  }
  if (!given().plot.empty()) {
    if (Status status = outputs.add(
            given().plot,
            [&](OutputFile& file) { return file.write(std::as_bytes(std::span(chart))); });
        !status) {
      return status;
    }
  }
  return outputs.finish();
}

Status Run::check_outputs() const {
  if (!given().plot.empty() && context_.one_of_many != nullptr) {
    return Error("usage", "--plot cannot be used in batch mode");
  }
  if (options_.changes_motion() && context_.output.empty()) {
    return Error("usage", "-o is missing", "it names the motion to write");
  }
  if (!options_.changes_motion() && !context_.output.empty()) {
    return Error("usage", "-o is given, but no goals",
                 "use --goals, --reach, --look-at or --plant");
  }
  return check_output_kind(context_.output, "-o", registry::Kind::anim);
}

Result<int> Run::run() {
  if (Status status = check_outputs(); !status) return status.error();
  solver_ = options_.solver;
  for (const auto step : {&Run::read_motion, &Run::read_limits, &Run::read_goals, &Run::add_points,
                          &Run::raise_goals, &Run::set_stiffness, &Run::plant_first}) {
    if (Status status = (this->*step)(); !status) return status.error();
  }
  if (!options_.has_goals()) return finish_without_goals();
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
  note_provenance(made->clip, "inverse kinematics: " + summary(outcome));
  std::string chart;
  if (!given().plot.empty()) {
    auto svg = draw::to_svg(chart_of(outcome, name_of_input(given().input)));
    if (!svg) return svg.error();
    chart = std::move(*svg);
  }
  if (Status status = write(&made->clip, chart); !status) return status.error();
  context_.report.result = to_json(outcome);
  if (given().plant) {
    context_.report.result["plant"] = std::move(planting_);
    context_.log(fmt::format("{}: {}", context_.output, planting_line_));
  }
  context_.log(fmt::format("{}: {}", context_.output, summary(outcome)));
  if (context_.verbose) context_.log(table(outcome));
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  return Run(options, context).run();
}

}  // namespace krok::cli::ik
