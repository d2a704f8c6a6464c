#include "tools/krok-ik/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "draw/plot.h"
#include "formats/anim/anim.h"
#include "formats/chart/chart_writer.h"
#include "formats/goals/goals.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/limits/limits_format.h"
#include "ik/anatomical_limits.h"
#include "ik/gaze.h"
#include "ik/limits.h"
#include "ik/whole_body.h"
#include "retarget/stance.h"
#include "roles/body_frame.h"
#include "scene/frame_source.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/krok-ik/outcome.h"
#include "tools/shared/goal_input.h"
#include "tools/shared/planting.h"

namespace krok::cli::ik {

namespace {

using krok::ik::Goal;

constexpr const char* kTurnedEyes = "eyes and head turned to what is looked at";

bool looks_with_eyes(const Options& options) {
  return std::ranges::any_of(options.looks,
                             [](const PointGoal& look) { return look.joint == "eyes"; });
}

class Run {
 public:
  Run(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<int> run(Clip motion);
  // `provenance` is that of the motion once all frames were read.
  Result<int> run(const FrameSource& motion, const std::function<Provenance()>& provenance);

 private:
  Status prepare();
  Status read_roles();
  Status read_character();
  Status read_limits();
  Status learn();
  Status read_goals();
  Status add_points();
  Status raise_goals();
  Status set_stiffness();
  Status plant_first();
  bool is_gaze(const PointGoal& point) const;
  Status turn_eyes(Clip& clip);
  Result<int> bring_about(const FrameSource& motion, const std::function<Provenance()>& of_input);
  void note_planting(const PlantedFeet& planted, bool contacts_given);
  Result<int> finish_without_goals();
  Result<int> write_without_goals(const FrameSource& made,
                                  const std::function<Provenance()>& of_input);
  Provenance provenance_of(const Provenance& before, const std::string& line) const;
  Result<int> joint_of(const std::string& option, const std::string& name) const;
  Status write(const FrameSource* made, const std::function<Provenance()>& provenance = {},
               const std::string& svg = {});

  const Options& options_;
  ToolContext& context_;
  Clip clip_;  // of a long take some of the frames, evenly over it
  io::FindRoles find_roles_;
  RoleMap roles_;
  krok::ik::Limits limits_;
  std::vector<krok::ik::KeyedGoal> goals_;
  Actor character_;     // empty without one
  OpenedGoals opened_;  // goals_ point to its motions
  krok::ik::Options solver_;
  Json planting_;
  Json gaze_ = Json::array();
  std::string planting_line_;
};

Status Run::read_roles() {
  const auto find = io::open_role_map(options_.map, context_);
  if (!find) return find.error();
  find_roles_ = *find;
  auto roles = find_roles_(clip_.skeleton);
  if (!roles) return roles.error();
  roles_ = std::move(*roles);
  if (clip_.skeleton.empty()) {
    return Error("ik-empty", "the motion has no joints").in_file(options_.input);
  }
  return {};
}

Status Run::read_character() {
  if (options_.character.empty()) return {};
  auto actor = io::open_actor(options_.character, context_, {.with_motions = false});
  if (!actor) return actor.error();
  character_ = *std::move(actor);
  return {};
}

bool Run::is_gaze(const PointGoal& point) const {
  return point.kind == Goal::Kind::look_at && point.joint == "eyes" &&
         clip_.skeleton.find("eyes") < 0;
}

// Last, as the head's own goals are what it looks ahead by.
Status Run::turn_eyes(Clip& clip) {
  std::vector<PointGoal> looks;
  std::ranges::copy_if(options_.looks, std::back_inserter(looks),
                       [this](const PointGoal& point) { return is_gaze(point); });
  if (looks.empty()) return {};
  const auto seconds = [&](const PointGoal& look, double time) {
    return look.in_frames ? time / clip_.rate : time;
  };
  std::ranges::stable_sort(looks, {},
                           [&](const PointGoal& look) { return seconds(look, look.from); });
  std::vector<krok::ik::GazeTarget> targets;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    targets.push_back({seconds(looks[i], looks[i].from), looks[i].target});
    const double end = seconds(looks[i], looks[i].to);
    const bool follows = i + 1 < looks.size() && seconds(looks[i + 1], looks[i + 1].from) <= end;
    if (!follows && end > targets.back().time) targets.push_back({end, {}});
  }
  const auto eyes = krok::ik::gaze_eyes(character_.eyes, character_.skeleton(), clip.skeleton);
  if (!eyes) return Error(eyes.error()).in_file(options_.input);
  auto made = krok::ik::apply_gaze(clip, *eyes, targets, roles_);
  if (!made) return Error(made.error()).in_file(options_.input);
  clip = std::move(made->clip);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const krok::ik::GazeFacts& facts = made->targets[k];
    gaze_.push_back({{"time", targets[k].time},
                     {"amplitude", facts.amplitude / kRadiansPerDegree},
                     {"head", facts.head / kRadiansPerDegree},
                     {"missed", facts.missed / kRadiansPerDegree}});
    if (facts.reached) continue;
    context_.warn("ik-gaze",
                  fmt::format("the eyes miss what they look at from {} s by {:.1f} "
                              "degrees: it is beyond the range of eyes and head, or "
                              "gone too soon",
                              readable(targets[k].time, 4), facts.missed / kRadiansPerDegree));
  }
  return {};
}

Status Run::learn() {
  std::deque<Clip> clips;
  std::vector<const Clip*> list;
  for (const std::string& path : options_.captures) {
    auto clip = io::open_motion(path, context_);
    if (!clip) return clip.error();
    clips.push_back(std::move(*clip));
    list.push_back(&clips.back());
  }
  auto limits = krok::ik::learn_limits(clip_.skeleton, list, {.margin = options_.margin});
  if (!limits) return std::move(limits).error().in_file(options_.captures.front());
  limits_ = std::move(*limits);
  return {};
}

Status Run::read_limits() {
  if (!options_.captures.empty()) return learn();
  if (options_.limits.empty()) return {};
  if (options_.limits == "auto") {
    if (!roles_.humanoid) {
      return Error("ik-roles", "--limits auto needs a humanoid; the motion's joints are not one's",
                   "krok-info -v lists the joints and their roles; --map assigns roles")
          .in_file(options_.input);
    }
    limits_ = krok::ik::anatomical_limits(retarget::neutral_skeleton(clip_, roles_), roles_);
    return {};
  }
  const auto file = context_.open_input(options_.limits);
  if (!file) return file.error();
  auto limits = limits::read(file->text(), clip_.skeleton);
  if (!limits) return std::move(limits).error().in_file(options_.limits);
  limits_ = std::move(*limits);
  return {};
}

Result<int> Run::joint_of(const std::string& option, const std::string& name) const {
  const int joint = find_joint(clip_.skeleton, roles_, name);
  if (joint >= 0) return joint;
  return Error("ik-joint",
               fmt::format("{} {}: the motion has no joint of that name or role", option,
                           shown(name)),
               nearest_hint(name, clip_.skeleton.names) + "; or a role, such as right_hand")
      .in_file(options_.input);
}

Status Run::read_goals() {
  if (options_.goals.empty()) return {};
  auto opened = open_goals(options_.goals, facing_skeleton(clip_, roles_), roles_, context_,
                           character_.sockets);
  if (!opened) return opened.error();
  opened_ = std::move(*opened);
  goals_ = opened_.goals;
  solver_.stiffness = opened_.stiffness;
  solver_.root_moves = solver_.root_moves || opened_.root_moves;
  return {};
}

// With --ground heights of goals in the world are over the ground.
Status Run::raise_goals() {
  if (options_.ground.empty()) return {};
  const auto ground = options_.ground.open(context_);
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
  std::vector<PointGoal> points = options_.points;
  points.insert(points.end(), options_.looks.begin(), options_.looks.end());
  for (const PointGoal& point : points) {
    if (is_gaze(point)) continue;
    const auto socket =
        std::ranges::find(character_.sockets, point.joint, &Character::Socket::name);
    const bool is_socket = socket != character_.sockets.end();
    const auto joint = joint_of(point.option, is_socket ? socket->joint : point.joint);
    if (!joint) return joint.error();
    krok::ik::KeyedGoal goal;
    if (is_socket) goal.goal.point = socket->offset.cast<double>();
    goal.name = clip_.skeleton.names[at(*joint)];
    goal.goal.kind = point.kind;
    goal.goal.joint = *joint;
    goal.goal.axis = goals::facing_axis(*joint, facing_skeleton(clip_, roles_), roles_);
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
  if (options_.depth) {
    for (krok::ik::KeyedGoal& goal : goals_) goal.goal.depth = *options_.depth;
  }
  return {};
}

Status Run::set_stiffness() {
  solver_.stiffness.resize(clip_.skeleton.names.size(), 0.0);
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
  const auto trunk = krok::ik::trunk_stiffness(clip_.skeleton, roles_, options_.whole_body);
  for (std::size_t j = 0; j < trunk.size(); ++j) {
    solver_.stiffness[j] = 1 - (1 - solver_.stiffness[j]) * (1 - trunk[j]);
  }
  solver_.moving_joint = krok::ik::moving_joint(clip_, roles_, goals_);
  // Of a root on the ground nothing is turned or shifted but for its own goals.
  for (int j = clip_.skeleton.parents[at(solver_.moving_joint)]; j >= 0;
       j = clip_.skeleton.parents[at(j)]) {
    if (std::ranges::find(goals_, j, [](const auto& g) { return g.goal.joint; }) == goals_.end()) {
      solver_.stiffness[at(j)] = 1;
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
          .in_file(options_.goals);
    }
  }
  return {};
}

// The goals are for the motion with its feet planted.
Status Run::plant_first() {
  if (!options_.plant) return {};
  const auto contacts =
      read_planting_contacts(options_.contacts, options_.input, frames_of(clip_), context_);
  if (!contacts) return contacts.error();
  auto planted = plant(clip_, roles_, *contacts);
  if (!planted) return std::move(planted).error().in_file(options_.input);
  note_planting(*planted, contacts->has_value());
  clip_ = std::move(planted->clip);
  return {};
}

void Run::note_planting(const PlantedFeet& planted, bool contacts_given) {
  context_.diagnose(planted.warnings);
  planting_ = planting_json(planted, contacts_given);
  planting_line_ = planting_line(planted);
}

// What was done to the motion, after what it says of itself.
Provenance Run::provenance_of(const Provenance& before, const std::string& line) const {
  Provenance provenance = context_.provenance();
  provenance.conversions = before.conversions;
  provenance.removed_root_motion = before.removed_root_motion;
  for (const std::string& done : {planting_line_, line}) {
    if (!done.empty()) provenance.conversions.push_back(done);
  }
  return provenance;
}

Result<int> Run::finish_without_goals() {
  if (!options_.changes_motion()) {
    if (Status status = write(nullptr); !status) return status.error();
    context_.report.result = limits_json(limits_, clip_.skeleton);
    context_.log(fmt::format("{}: {}", options_.write_limits, limits_summary(limits_)));
    return kExitDone;
  }
  Clip planted = std::move(clip_);
  clip_.skeleton = planted.skeleton;
  clip_.rate = planted.rate;
  if (Status status = turn_eyes(planted); !status) return status.error();
  return write_without_goals(frames_of(planted), [&] { return planted.provenance; });
}

Result<int> Run::write_without_goals(const FrameSource& made,
                                     const std::function<Provenance()>& of_input) {
  const auto provenance = [&] {
    return provenance_of(of_input(), gaze_.empty() ? "" : kTurnedEyes);
  };
  if (Status status = write(&made, provenance); !status) return status.error();
  context_.report.result["frames"] = made.frame_count;
  if (options_.plant) context_.report.result["plant"] = std::move(planting_);
  if (!gaze_.empty()) context_.report.result["gaze"] = std::move(gaze_);
  context_.log(
      fmt::format("{}: {}", context_.output, options_.plant ? planting_line_ : kTurnedEyes));
  return kExitDone;
}

Status Run::write(const FrameSource* made, const std::function<Provenance()>& provenance,
                  const std::string& svg) {
  OutputSet outputs(context_);
  if (!options_.write_limits.empty()) {
    const std::string text = limits::write(limits_, clip_.skeleton);
    if (Status status = outputs.add(options_.write_limits, std::as_bytes(std::span(text)));
        !status) {
      return status;
    }
  }
  if (made != nullptr) {
    anim::WriteOptions writing;
    writing.orientation = options_.orientation;
    writing.jobs = context_.jobs;
    if (Status status = outputs.add(
            context_.output,
            [&](OutputFile& file) { return anim::write(*made, provenance, writing, file); });
        !status) {
      return status;
    }
  }
  if (!options_.plot.empty()) {
    if (Status status =
            outputs.add(options_.plot,
                        [&](OutputFile& file) { return chart::write(options_.plot, svg, file); });
        !status) {
      return status;
    }
  }
  return outputs.finish();
}

Status check_outputs(const Options& options, const ToolContext& context) {
  if (!options.plot.empty() && context.one_of_many != nullptr) {
    return Error("usage", "--plot cannot be used in batch mode");
  }
  if (options.changes_motion() && context.output.empty()) {
    return no_output_for(options.input);
  }
  if (!options.changes_motion() && !context.output.empty()) {
    return Error("usage", "-o is given, but no goals",
                 "use --goals, --reach, --look-at or --plant");
  }
  return {};
}

Status Run::prepare() {
  solver_ = options_.solver;
  for (const auto step :
       {&Run::read_roles, &Run::read_character, &Run::read_limits, &Run::read_goals,
        &Run::add_points, &Run::raise_goals, &Run::set_stiffness}) {
    if (Status status = (this->*step)(); !status) return status;
  }
  return {};
}

Result<int> Run::run(Clip motion) {
  clip_ = std::move(motion);
  if (Status status = prepare(); !status) return status.error();
  if (Status status = plant_first(); !status) return status.error();
  if (goals_.empty()) {
    if (!options_.plot.empty()) return usage("--plot shows goals, of which eyes are none");
    return finish_without_goals();
  }
  return bring_about(frames_of(clip_), [this] { return clip_.provenance; });
}

Result<int> Run::run(const FrameSource& motion, const std::function<Provenance()>& provenance) {
  // As many as facing_skeleton() looks at.
  const int step = std::max(1, motion.frame_count / 200);
  clip_.skeleton = motion.skeleton;
  clip_.rate = motion.rate;
  for (int f = 0; f < motion.frame_count; f += step) {
    const auto frame = load(part_of(motion, f, 1), 1);
    if (!frame) return frame.error();
    std::ranges::copy(frame->positions, std::back_inserter(clip_.positions));
    std::ranges::copy(frame->orientations, std::back_inserter(clip_.orientations));
  }
  if (Status status = prepare(); !status) return status.error();
  if (!options_.plant) return bring_about(motion, provenance);
  const auto contacts = read_planting_contacts(options_.contacts, options_.input, motion, context_);
  if (!contacts) return contacts.error();
  const PlantedFrames planted =
      plant_frames(motion, roles_, *contacts, provenance().removed_root_motion, context_);
  const auto of_planted = [&] {
    note_planting(planted.done(), contacts->has_value());
    return provenance();
  };
  return goals_.empty() ? write_without_goals(planted.frames, of_planted)
                        : bring_about(planted.frames, of_planted);
}

Result<int> Run::bring_about(const FrameSource& motion,
                             const std::function<Provenance()>& of_input) {
  krok::ik::GoalMotionOptions how;
  how.solver = solver_;
  how.jobs = context_.jobs;
  if (roles_.humanoid) how.upright = roles_.joints(Role::head);
  const bool has_legs = roles_.joint(Role::left_foot) >= 0 || roles_.joint(Role::right_foot) >= 0;
  how.held = has_legs ? krok::ik::legs_without_goals(clip_, roles_, goals_)
                      : krok::ik::ends_on_ground(clip_, goals_);
  if (limits_.empty() && roles_.humanoid) {
    how.ranges = krok::ik::anatomical_limits(retarget::neutral_skeleton(clip_, roles_), roles_);
  }
  const std::string& asked = options_.goals.empty() ? options_.input : options_.goals;
  auto made = krok::ik::apply_goals(motion, goals_, limits_, how);
  if (!made) return std::move(made).error().in_file(asked);
  made->frames.read = [read = made->frames.read, &asked](auto... block) -> Status {
    Status status = read(block...);
    if (status || !status.error().code.starts_with("ik-")) return status;
    return std::move(status).error().in_file(asked);
  };
  const Outcome outcome{motion, goals_, limits_, *made->motion};
  bool all_reached = true, diagnosed = false;
  const auto diagnose = [&] {
    if (std::exchange(diagnosed, true)) return;
    for (Diagnostic& missed : missed_goals(outcome)) {
      all_reached = false;
      missed.where.file = options_.input;
      context_.diagnose(std::move(missed));
    }
    context_.diagnose_in(options_.input, !has_legs && how.held.empty()
                                             ? moved_body(outcome)
                                             : moved_feet(outcome, how.held));
    context_.diagnose_in(options_.input, beyond_ranges(outcome));
  };
  std::string chart;
  if (looks_with_eyes(options_) || !options_.plot.empty()) {
    auto loaded = load(made->frames, context_.jobs);
    if (!loaded) return loaded.error();
    Clip& whole = made->motion->clip = *std::move(loaded);
    diagnose();
    if (!options_.plot.empty()) {
      auto svg = draw::to_svg(chart_of(outcome, clip_, name_of_input(options_.input)));
      if (!svg) return svg.error();
      chart = std::move(*svg);
    }
    // Eyes may be added to the skeleton.
    if (Status status = turn_eyes(whole); !status) return status.error();
    made->frames = frames_of(whole);
  }
  const auto provenance = [&] {
    diagnose();
    return provenance_of(of_input(), "inverse kinematics: " + summary(outcome));
  };
  if (Status status = write(&made->frames, provenance, chart); !status) return status.error();
  const bool is_reported = !context_.report_path.empty() || context_.one_of_many != nullptr;
  context_.report.result = to_json(outcome, is_reported);
  if (!gaze_.empty()) context_.report.result["gaze"] = std::move(gaze_);
  if (options_.plant) {
    context_.report.result["plant"] = std::move(planting_);
    context_.log(fmt::format("{}: {}", context_.output, planting_line_));
  }
  context_.log(fmt::format("{}: {}", context_.output, summary(outcome)));
  if (context_.verbose) context_.log(table(outcome));
  return options_.strict && !all_reached ? kExitNo : kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  constexpr std::size_t kLongBytes = std::size_t{16} << 20;
  if (Status status = check_outputs(options, context); !status) return status.error();
  auto input = context.open_long_input(options.input);
  if (!input) return input.error();
  if (input->bytes().size() < kLongBytes || !options.changes_motion() || !options.plot.empty() ||
      options.limits == "auto" || looks_with_eyes(options)) {
    context.note_checksum(*input);
    auto clip = io::open_motion(*input, context);
    if (!clip) return clip.error();
    { const InputFile closed = *std::move(input); }  // its mapping takes memory
    return Run(options, context).run(*std::move(clip));
  }
  const io::ChecksumAtEnd checksum(*input, context);
  std::function<Provenance()> of_input;
  const auto provenance = [&] {
    context.note_checksum(*input);
    return of_input();
  };
  int exit_code = kExitDone;
  const auto use = [&](const FrameSource& frames) -> Status {
    const auto made = Run(options, context).run(frames, provenance);
    if (!made) return made.error();
    exit_code = *made;
    return {};
  };
  const auto read = io::stream_motion(*input, context, use, {.provenance = &of_input});
  if (!read) return read.error();
  return exit_code;
}

}  // namespace krok::cli::ik
