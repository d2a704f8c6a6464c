// Walks of captures as rigs and exporters make them: a root that stands at the origin, slides on
// the ground or is the hips; a reference pose that lies, or has the trunk a quarter round; feet
// whose joints have axes of their own, no toes, or toes that point outwards. If these fail, the
// walker of a capture that nobody tuned for swings from side to side, or stands on its toes.

#include <gtest/gtest.h>

#include "core/index.h"
#include "gait/plan_prints.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "parametric/thin_out.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

using samples::Rig;

constexpr double kGeneratedToeOut = 6 * kRadiansPerDegree;  // radians, of the generator's walks

struct FeetCase {
  std::string name;
  Rig rig = Rig::hips;
  bool has_toes = true;
  double toe_out = 0;      // radians
  double axes_turned = 0;  // radians, of the foot joints' own axes
  bool is_twisted = false;
};

// Joints `first` and below.
std::vector<int> part_of(const Skeleton& skeleton, int first) {
  std::vector<int> part;
  for (int j = first; j < skeleton.joint_count(); ++j) {
    int above = j;
    while (above > first) above = skeleton.parents[at(above)];
    if (above == first) part.push_back(j);
  }
  return part;
}

// In all frames, about the ankle and the sole's normal, as people walk who turn their toes out.
void turn_toes_out(Clip& clip, FootSide side, double angle) {
  const int foot =
      find_roles(clip.skeleton).joint(side == FootSide::left ? Role::left_foot : Role::right_foot);
  const Quat turn = axis_rotation(Axis::y, side == FootSide::left ? angle : -angle);
  const auto turned = [&](const Transform& ankle, const Quat& to_reference,
                          const Transform& joint) {
    const Quat around = to_reference * turn * to_reference.conjugate();
    return Transform{ankle.position + around * (joint.position - ankle.position),
                     around * joint.orientation};
  };
  const Transform own = clip.skeleton.reference[at(foot)];
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    const Transform ankle = pose[at(foot)];
    const Quat from_reference = ankle.orientation * own.orientation.conjugate();
    for (const int j : part_of(clip.skeleton, foot)) {
      pose[at(j)] = turned(ankle, from_reference, pose[at(j)]);
    }
    clip.set_pose(f, pose);
  }
}

void turn_axes(Clip& clip, int joint, double angle) {
  const Quat turn = axis_rotation(Axis::x, angle) * axis_rotation(Axis::z, 0.7 * angle);
  Quat& reference = clip.skeleton.reference[at(joint)].orientation;
  reference = reference * turn;
  for (int f = 0; f < clip.frame_count(); ++f) {
    Quatf& orientation = clip.frame_orientations(f)[at(joint)];
    orientation = (orientation.cast<double>() * turn).normalized().cast<float>();
  }
}

Clip without(const Clip& clip, const std::vector<int>& joints) {
  Clip result;
  result.rate = clip.rate;
  std::vector<int> kept, new_index(clip.skeleton.names.size(), Skeleton::kNoParent);
  for (int j = 0; j < clip.joint_count(); ++j) {
    if (std::ranges::find(joints, j) != joints.end()) continue;
    const int parent = clip.skeleton.parents[at(j)];
    new_index[at(j)] = static_cast<int>(kept.size());
    kept.push_back(j);
    result.skeleton.add(clip.skeleton.names[at(j)],
                        parent < 0 ? Skeleton::kNoParent : new_index[at(parent)],
                        clip.skeleton.reference[at(j)], clip.skeleton.end_sites[at(j)] != 0);
  }
  result.resize(clip.frame_count());
  std::vector<Transform> pose(clip.skeleton.names.size()), some(kept.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    for (std::size_t k = 0; k < kept.size(); ++k) some[k] = pose[at(kept[k])];
    result.set_pose(f, some);
  }
  return result;
}

// The reference pose's trunk is turned a quarter round above the hips.
void twist_trunk(Clip& clip) {
  const int spine = find_roles(clip.skeleton).joint(Role::spine);
  ASSERT_GE(spine, 0);
  const Transform here{clip.skeleton.reference[at(spine)].position, Quat::Identity()};
  const Transform twist =
      here * Transform{Vec3::Zero(), axis_rotation(Axis::y, kPi / 2)} * here.inverse();
  for (const int j : part_of(clip.skeleton, spine)) {
    clip.skeleton.reference[at(j)] = twist * clip.skeleton.reference[at(j)];
  }
}

Clip on_rig(Clip clip, const FeetCase& given) {
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    turn_toes_out(clip, side, given.toe_out);
    const int foot = find_roles(clip.skeleton)
                         .joint(side == FootSide::left ? Role::left_foot : Role::right_foot);
    if (!given.has_toes) {
      std::vector<int> below = part_of(clip.skeleton, foot);
      below.erase(below.begin());
      clip = without(clip, below);
    }
    turn_axes(clip, foot, given.axes_turned);
  }
  if (given.is_twisted) twist_trunk(clip);
  return samples::with_rig(clip, given.rig);
}

// Steps of both feet on level ground, straight and round bends, mirrored too.
StepLibrary library_on(const FeetCase& given) {
  std::vector<parametric::test::KeyedWalk> walks;
  for (const double turn : {-0.25, 0.0, 0.25}) {
    for (const double length : {0.5, 0.65, 0.75}) {
      samples::WalkOptions options;
      options.steps = 5;
      options.step_length = length;
      options.turn = turn;
      walks.push_back(parametric::test::keyed_walk(options));
      parametric::test::KeyedWalk& keyed = walks.back();
      keyed.walk.clip = on_rig(std::move(keyed.walk.clip), given);
      auto found = find_contacts(keyed.walk.clip, find_roles(keyed.walk.clip.skeleton));
      EXPECT_TRUE(found.ok());
      keyed.found = *std::move(found);
      keyed.keys.contacts = keyed.found.contacts;
    }
  }
  auto library = parametric::test::library_of(walks, {"step.length", "step.path_turn"}).library;
  // Steps of a walk are alike.
  std::vector<parametric::Example> kept;
  for (const int i : parametric::thin_out(library, 0.2)) kept.push_back(library.examples[at(i)]);
  library.examples = std::move(kept);
  return test::walking_library(std::move(library));
}

double heading_between(const Clip& clip, int frame, int left, int right) {
  const Vec3f across =
      clip.frame_positions(frame)[at(left)] - clip.frame_positions(frame)[at(right)];
  return std::atan2(-across.z(), across.x());
}

class FeetOfRigs : public testing::TestWithParam<FeetCase> {};
INSTANTIATE_TEST_SUITE_P(
    Rigs, FeetOfRigs,
    testing::Values(FeetCase{"Plain"}, FeetCase{.name = "StaticRoot", .rig = Rig::static_root},
                    FeetCase{.name = "GroundRoot", .rig = Rig::ground_root, .toe_out = 0.2},
                    FeetCase{.name = "Lying", .rig = Rig::lying},
                    FeetCase{.name = "ToesOut", .toe_out = kPi / 6},
                    FeetCase{.name = "NoToes", .has_toes = false},
                    FeetCase{.name = "AxesTurned", .axes_turned = kPi / 2},
                    FeetCase{.name = "Twisted", .rig = Rig::static_root, .is_twisted = true},
                    FeetCase{"All", Rig::static_root, false, kPi / 6, kPi / 2, true}),
    [](const auto& given) { return given.param.name; });

// Hips and shoulders face along the way, as far as the captured ones do; feet that are planted lie
// flat as the captured ones did.
TEST_P(FeetOfRigs, TheBodyFacesItsWayAndFeetLieFlat) {
  std::vector<StepLibrary> libraries;
  libraries.push_back(library_on(GetParam()));
  auto plan = usual_steps(libraries);
  ASSERT_TRUE(plan.ok());
  EXPECT_NEAR(plan->toe_out[0], kGeneratedToeOut + GetParam().toe_out, 2 * kRadiansPerDegree);
  const double heading = 0.4;
  const std::vector<PathPoint> ends = {{0, 0, {}},
                                       {5 * std::sin(heading), 5 * std::cos(heading), {}}};
  const auto path = Path::create(ends);
  ASSERT_TRUE(path.ok());
  const test::Ground ground([](double, double) { return 0.0; });
  const auto prints = plan_prints(*path, ground, *plan);
  ASSERT_TRUE(prints.ok()) << prints.error().message;
  const auto made = walk(libraries, prints->prints, ground, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const Clip& clip = made->clip;
  const RoleMap roles = find_roles(clip.skeleton);
  const auto off_way = [&](Role left, Role right) {
    double sum = 0, most = 0;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const double off =
          wrapped(heading_between(clip, f, roles.joint(left), roles.joint(right)) - heading);
      sum += off / clip.frame_count();
      most = std::max(most, std::abs(off));
    }
    EXPECT_LT(std::abs(sum), 2 * kRadiansPerDegree) << role_name(left);
    EXPECT_LT(most, 12 * kRadiansPerDegree) << role_name(left);
  };
  off_way(Role::left_upper_leg, Role::right_upper_leg);
  off_way(Role::left_upper_arm, Role::right_upper_arm);
  // No joint of the trunk is turned in its parent as no captured one is.
  const Clip& captured = libraries[0].library().examples.front().motion;
  for (const Role role : {Role::spine, Role::neck, Role::head}) {
    const int joint = roles.joint(role), parent = clip.skeleton.parents[at(joint)];
    const auto in_parent = [&](const Clip& one, int frame) {
      const auto pose = one.frame_orientations(frame);
      return Quat(pose[at(parent)].cast<double>().conjugate() * pose[at(joint)].cast<double>());
    };
    for (int f = 0; f < clip.frame_count(); f += 5) {
      EXPECT_LT(angle_between(in_parent(clip, f), in_parent(captured, 0)), 30 * kRadiansPerDegree)
          << role_name(role) << " frame " << f;
    }
  }
  for (const Contact& contact : made->details.keys.contacts) {
    for (const FootSide side : {FootSide::left, FootSide::right}) {
      const parametric::FootShape& foot = libraries[0].library().foot(side);
      if (contact.joint != foot.joint) continue;
      const int f = static_cast<int>(std::lround((contact.start + contact.end) / 2 * clip.rate));
      const Quat orientation = clip.frame_orientations(f)[at(foot.joint)].cast<double>();
      // Generated feet are level where they are in the reference pose, which stands or lies.
      const Quat stood =
          GetParam().rig == Rig::lying ? axis_rotation(Axis::x, kPi / 2) : Quat::Identity();
      const Vec3 up = orientation *
                      (stood * clip.skeleton.reference[at(foot.joint)].orientation).conjugate() *
                      Vec3::UnitY();
      EXPECT_GT(up.y(), std::cos(1.5 * kRadiansPerDegree))
          << clip.skeleton.names[at(foot.joint)] << " frame " << f;
    }
  }
}

}  // namespace
}  // namespace krok::gait
