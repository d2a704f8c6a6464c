#include "tools/krok-view/goals.h"
#include "roles/body_frame.h"

#include <algorithm>
#include <limits>

#include "core/index.h"
#include "ik/anatomical_limits.h"
#include "ik/solver.h"
#include "roles/roles.h"
#include "tools/shared/goal_input.h"

namespace krok::cli::view {

namespace {

using krok::ik::Goal;

const char* name_of_kind(Goal::Kind kind) {
  switch (kind) {
    case Goal::Kind::position:
      return "position";
    case Goal::Kind::orientation:
      return "orientation";
    case Goal::Kind::pose:
      return "pose";
    case Goal::Kind::look_at:
      return "look-at";
    case Goal::Kind::pole:
      return "pole";
    case Goal::Kind::balance:
      break;
  }
  return "balance";
}

// From the end effector upwards.
std::vector<int> chain_of(const Goal& goal, const Skeleton& skeleton) {
  std::vector<int> chain;
  if (goal.kind == Goal::Kind::balance) return chain;
  for (int joint = goal.joint; joint >= 0; joint = skeleton.parents[at(joint)]) {
    if (goal.depth > 0 && static_cast<int>(chain.size()) == goal.depth) break;
    chain.push_back(joint);
  }
  return chain;
}

class GoalViewer {
 public:
  GoalViewer(const Clip& clip, const RoleMap& roles)
      : clip_(clip),
        body_(krok::ik::body_masses(clip.skeleton, roles)),
        pose_(clip.skeleton.names.size()) {
    options_.masses = body_.masses;
    options_.mass_centres = body_.centres;
    options_.iterations = 0;
  }

  // The solver says what is wrong with a goal.
  Status check(const krok::ik::KeyedGoal& keyed) {
    auto solver = krok::ik::Solver::create(clip_.skeleton.parents, {}, options_);
    if (!solver) return solver.error();
    clip_.get_pose(0, pose_);
    const Goal goal = goal_in_frame(keyed, clip_, 0);
    const auto outcome = solver->solve({&goal, 1}, pose_);
    return outcome ? Status() : Status(outcome.error());
  }

  draw::ViewedGoal view(const krok::ik::KeyedGoal& keyed) {
    draw::ViewedGoal viewed;
    viewed.name = keyed.name;
    viewed.kind = name_of_kind(keyed.goal.kind);
    viewed.chain = chain_of(keyed.goal, clip_.skeleton);
    for (int f = 0; f < clip_.frame_count(); ++f) viewed.frames.push_back(frame(keyed, f));
    return viewed;
  }

 private:
  draw::ViewedGoal::Frame frame(const krok::ik::KeyedGoal& keyed, int f) {
    draw::ViewedGoal::Frame shown;
    shown.strength = strength_at(keyed, f / clip_.rate, clip_.duration());
    if (!(shown.strength > 0)) return shown;
    const Goal goal = goal_in_frame(keyed, clip_, f);
    clip_.get_pose(f, pose_);
    const auto missed = residuals({&goal, 1}, clip_.skeleton.parents, pose_, options_);
    shown.distance = missed.front().distance;
    shown.angle = missed.front().angle;
    set_ends(keyed, goal, shown);
    return shown;
  }

  // The line that is drawn: from what is moved to where it is to be, or to point to.
  void set_ends(const krok::ik::KeyedGoal& keyed, const Goal& goal,
                draw::ViewedGoal::Frame& shown) const {
    switch (goal.kind) {
      case Goal::Kind::balance:
        shown.from = shown.to = centre_of_mass();
        shown.to.y() = lowest(keyed.support_joints);
        return;
      case Goal::Kind::orientation:
        shown.from = shown.to = pose_[at(goal.joint)].position;
        return;
      case Goal::Kind::pole:
        shown.from = pose_[at(goal.joint)].position;
        break;
      default:
        shown.from = pose_[at(goal.joint)] * goal.point;
        break;
    }
    shown.to = goal.target;
  }

  Vec3 centre_of_mass() const {
    Vec3 sum = Vec3::Zero();
    double mass = 0;
    for (std::size_t j = 0; j < pose_.size(); ++j) {
      sum += body_.masses[j] * (pose_[j] * body_.centres[j]);
      mass += body_.masses[j];
    }
    return mass > 0 ? Vec3(sum / mass) : pose_[0].position;
  }

  double lowest(const std::vector<int>& joints) const {
    double low = std::numeric_limits<double>::infinity();
    for (const int joint : joints) low = std::min(low, pose_[at(joint)].position.y());
    return joints.empty() ? 0 : low;
  }

  const Clip& clip_;
  krok::ik::BodyMasses body_;
  krok::ik::Options options_;
  std::vector<Transform> pose_;
};

}  // namespace

Result<std::vector<draw::ViewedGoal>> viewed_goals(const std::string& path, const Clip& clip,
                                                   ToolContext& context) {
  const RoleMap roles = find_roles(clip.skeleton);
  const auto opened = open_goals(path, facing_skeleton(clip, roles), roles, context);
  if (!opened) return opened.error();
  std::vector<draw::ViewedGoal> all;
  if (clip.frame_count() == 0) return all;
  GoalViewer viewer(clip, roles);
  for (const krok::ik::KeyedGoal& goal : opened->goals) {
    if (Status status = viewer.check(goal); !status) {
      return std::move(status).error().in_file(path);
    }
    all.push_back(viewer.view(goal));
  }
  return all;
}

}  // namespace krok::cli::view
