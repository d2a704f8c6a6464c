// If these fail, takes of one session come in turned against each other.

#include "cli/motion_fixture.h"
#include "math/quaternion.h"
#include "roles/roles.h"

namespace krok::test {
namespace {

class AxesOfTakes : public MotionTest {
 protected:
  Clip imported(std::vector<std::string> options) const {
    options.insert(options.begin(), {"lying.bvh", "-o", "out.anim"});
    const ToolRun run = run_here("krok-import", options);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read("out.anim");
  }
};

// A take that lies throughout shows no up axis where the reference pose does not stand either: its
// siblings would be turned against it.
TEST_F(AxesOfTakes, MayComeFromAnotherTake) {
  Clip walk = samples::make_walk(samples::WalkOptions())->clip;
  const RoleMap roles = find_roles(walk.skeleton);
  for (const Role hip : {Role::left_upper_leg, Role::right_upper_leg}) {
    const auto thigh = static_cast<std::size_t>(roles.joint(hip));
    const Vec3 pivot = walk.skeleton.reference[thigh].position;
    std::vector<char> below(walk.skeleton.names.size(), 0);
    for (std::size_t j = thigh; j < below.size(); ++j) {
      const int parent = walk.skeleton.parents[j];
      below[j] = j == thigh || below[static_cast<std::size_t>(parent)] != 0 ? 1 : 0;
      if (below[j] == 0) continue;
      Vec3& p = walk.skeleton.reference[j].position;
      p.y() = 2 * pivot.y() - p.y();
    }
  }
  Clip lying = walk;
  const Transform lie{Vec3(0, 0.2, 0), from_rotation_vector(Vec3(-kPi / 2, 0, 0))};
  std::vector<Transform> pose(walk.skeleton.names.size());
  for (int f = 0; f < walk.frame_count(); ++f) {
    walk.get_pose(f, pose);
    for (Transform& joint : pose) joint = lie * joint;
    lying.set_pose(f, pose);
  }
  write("walk.anim", walk);
  write("lying.anim", lying);
  for (const std::string name : {"walk", "lying"}) {
    const ToolRun run =
        run_here("krok-export", {name + ".anim", "-o", name + ".bvh", "--unit", "cm"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    take_mark_from(name + ".bvh");
  }
  const auto hips = static_cast<std::size_t>(roles.joint(Role::hips));
  const auto head = static_cast<std::size_t>(roles.joint(Role::head));
  const auto along = [&](const Clip& clip) {
    const auto positions = clip.frame_positions(clip.frame_count() / 2);
    return Vec3f(positions[head] - positions[hips]).normalized();
  };
  const Clip alone = imported({});
  EXPECT_GT(along(alone).y(), 0.9F);  // taken for standing
  const Clip sibling = imported({"--axes-from", "walk.bvh"});
  EXPECT_LT((along(sibling) - along(lying)).norm(), 1e-3F);
  // In one batch they agree by themselves, whichever comes first.
  const ToolRun batch = run_here(
      "krok-import", {"lying.bvh", "walk.bvh", "--out-dir", "together", "--json=report.json"});
  EXPECT_EQ(batch.exit_code, 0) << batch.err;
  EXPECT_LT((along(read("together/lying.anim")) - along(lying)).norm(), 1e-3F);
  EXPECT_LT((along(read("together/walk.anim")) - along(walk)).norm(), 1e-3F);
  const ToolRun both = run_here(
      "krok-import", {"lying.bvh", "-o", "no.anim", "--axes-from", "walk.bvh", "--up", "y"});
  EXPECT_EQ(both.exit_code, 2);
}

}  // namespace
}  // namespace krok::test
