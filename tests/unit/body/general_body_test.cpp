// Bodies of figures that are no humans: if these fail, some skeleton gives no body, a broken one,
// or hangs.

#include <string>

#include "support/human_skeleton.h"
#include "unit/body/mesh_checks.h"

namespace krok {
namespace {

using test::build;
using test::expect_valid_body;

int add(Skeleton& skeleton, const std::string& name, int parent, const Vec3& offset,
        bool end = false) {
  Transform transform;
  transform.position = offset;
  if (parent >= 0)
    transform.position += skeleton.reference[static_cast<std::size_t>(parent)].position;
  return skeleton.add(name, parent, transform, end);
}

Body build_low(const Skeleton& skeleton) {
  return build(skeleton, {.detail = BodyDetail::low});
}

Skeleton dog() {
  Skeleton dog;
  const int hips = add(dog, "pelvis", -1, {0, 0.6, -0.35});
  const int back = add(dog, "back", hips, {0, 0.03, 0.25});
  const int chest = add(dog, "withers", back, {0, 0.0, 0.30});
  const int neck = add(dog, "throat", chest, {0, 0.18, 0.15});
  const int skull = add(dog, "skull", neck, {0, 0.08, 0.08});
  add(dog, "snout", skull, {0, -0.03, 0.20}, true);
  const int tail = add(dog, "tail1", hips, {0, 0.05, -0.12});
  add(dog, "tail2", tail, {0, 0.1, -0.2}, true);
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "l" : "r";
    for (const int base : {chest, hips}) {
      const std::string leg = name + (base == chest ? "fore" : "hind");
      const int upper = add(dog, leg + "1", base, {0.09 * side, -0.08, 0});
      const int lower = add(dog, leg + "2", upper, {0, -0.25, 0.02});
      add(dog, leg + "3", lower, {0, -0.25, 0}, true);
    }
  }
  return dog;
}

TEST(GeneralBody, OfADog) {
  const Body body = build(dog());
  expect_valid_body(body);
  EXPECT_FALSE(body.human);
  // The trunk is thicker than a leg.
  double trunk = 0, leg = 0;
  for (const Vec3f& p : body.model.positions) {
    if (std::abs(p.z()) < 0.03f) trunk = std::max<double>(trunk, std::abs(p.x()));
    if (std::abs(p.y() - 0.15f) < 0.02f && p.x() > 0) leg = std::max<double>(leg, p.x() - 0.09f);
  }
  EXPECT_GT(trunk, 1.3 * leg);
  EXPECT_GT(leg, 0.005);
}

// A dog over a root on the ground, with IK targets in front of it and eyes: none of them shows.
TEST(GeneralBody, HasNoFleshOnBonesThatAreNoPartOfIt) {
  Skeleton rig;
  const int root = add(rig, "reference", -1, Vec3::Zero());
  const Skeleton own = dog();
  for (int j = 0; j < own.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    rig.add(own.names[at], own.parents[at] < 0 ? root : own.parents[at] + 1, own.reference[at],
            own.end_sites[at] != 0);
  }
  const int target = add(rig, "PoleTargetL", root, {0.1, 0.5, 1.5});
  add(rig, "PoleTargetL_end", target, {0, 0.2, 0}, true);
  add(rig, "IK_foot", root, {0.3, 0, 0.9});
  for (const double side : {1.0, -1.0}) {
    add(rig, side > 0 ? "eye_l" : "eye_r", rig.find("skull"), {0.12 * side, 0.12, 0.05});
  }
  const Body with = build_low(rig), without = build_low(own);
  expect_valid_body(with);
  EXPECT_NEAR(with.volume / without.volume, 1, 0.02);
  const auto size = [](const Body& body) {
    Eigen::AlignedBox3f box;
    for (const Vec3f& p : body.model.positions) box.extend(p);
    return box;
  };
  EXPECT_LT((size(with).min() - size(without).min()).norm(), 0.01);
  EXPECT_LT((size(with).max() - size(without).max()).norm(), 0.01);
}

// A tree's trunk and a crane's post stand on the ground, too, and are what the rest hangs on.
TEST(GeneralBody, HasFleshOnTrunksAndPosts) {
  const auto thickness_at = [](const Body& body, float height) {
    float widest = 0;
    for (const Vec3f& p : body.model.positions) {
      if (std::abs(p.y() - height) < 0.1f && std::abs(p.x()) < 0.5f)
        widest = std::max(widest, std::abs(p.z()));
    }
    return widest;
  };
  Skeleton tree, crane;
  const int crown = add(tree, "crown", add(tree, "trunk", -1, Vec3::Zero()), {0, 2, 0});
  for (const double x : {-1.0, 0.0, 1.0})
    add(tree, "twig" + std::to_string(x), crown, {x, 0.8, 0}, true);
  const int post = add(crane, "post", add(crane, "base", -1, Vec3::Zero()), {0, 2, 0});
  const int wrist = add(crane, "wrist", add(crane, "boom", post, {2, 0, 0}), {0, -1.5, 0});
  for (const double z : {-0.2, 0.2})
    add(crane, "grip" + std::to_string(z), wrist, {0, -0.4, z}, true);
  for (const Skeleton& skeleton : {tree, crane}) {
    const Body body = build_low(skeleton);
    expect_valid_body(body);
    EXPECT_GT(thickness_at(body, 1), 0.03f);
  }
}

TEST(GeneralBody, OfAChainBelongsToTheJointAtEachBonesStart) {
  Skeleton chain;
  int parent = -1;
  for (int i = 0; i < 5; ++i) {
    parent =
        add(chain, "link" + std::to_string(i), parent, parent < 0 ? Vec3::Zero() : Vec3(0, 0.5, 0));
  }
  const Body body = build_low(chain);
  expect_valid_body(body);
  for (std::size_t v = 0; v < body.model.positions.size(); ++v) {
    const double bone = body.model.positions[v].y() / 0.5;
    const double within = bone - std::floor(bone);
    if (bone < 0 || bone > 4 || within < 0.4 || within > 0.6) continue;
    EXPECT_EQ(body.model.influence_joints[4 * v], static_cast<int>(std::floor(bone)));
    EXPECT_GT(body.model.influence_weights[4 * v], 0.6f);
  }
}

TEST(GeneralBody, OfOneJointIsABall) {
  Skeleton one;
  add(one, "only", -1, {3, 4, 5});
  const Body body = build_low(one);
  expect_valid_body(body);
  for (const Vec3f& p : body.model.positions) {
    ASSERT_NEAR((p.cast<double>() - Vec3(3, 4, 5)).norm(), 0.1, 0.01);
  }
}

TEST(GeneralBody, OfJointsInOnePointIsABall) {
  Skeleton heap;
  const int root = add(heap, "a", -1, Vec3::Zero());
  const int b = add(heap, "b", root, Vec3::Zero());
  add(heap, "c", root, Vec3::Zero());
  add(heap, "d", b, Vec3::Zero(), true);
  const Body body = build_low(heap);
  expect_valid_body(body);
}

TEST(GeneralBody, PassesOverBonesOfNoLength) {
  Skeleton skeleton;
  int joint = add(skeleton, "root", -1, Vec3::Zero());
  for (int i = 0; i < 4; ++i) {
    joint = add(skeleton, "still" + std::to_string(i), joint, Vec3::Zero());
    add(skeleton, "side" + std::to_string(i), joint, Vec3::Zero(), true);
    joint = add(skeleton, "bone" + std::to_string(i), joint, {0.3, i % 2 ? 0.2 : -0.2, 0});
  }
  const Body body = build_low(skeleton);
  expect_valid_body(body);
}

TEST(GeneralBody, OfTwoHundredJoints) {
  // A hub with many arms, as faces and hands have them.
  Skeleton skeleton;
  const int hub = add(skeleton, "hub", -1, {0, 1, 0});
  for (int arm = 0; arm < 20; ++arm) {
    const double turn = arm * 2.399963;  // the golden angle spreads them over the sphere
    const double height = 1 - 2 * (arm + 0.5) / 20, ring = std::sqrt(1 - height * height);
    const Vec3 direction(ring * std::cos(turn), height, ring * std::sin(turn));
    int joint = hub;
    for (int i = 0; i < 10; ++i) {
      joint = add(skeleton, "a" + std::to_string(arm) + "_" + std::to_string(i), joint,
                  0.1 * direction);
    }
  }
  const Body body = build(skeleton);
  EXPECT_EQ(skeleton.joint_count(), 201);
  expect_valid_body(body);
}

TEST(GeneralBody, OfAnySize) {
  for (const double scale : {1e-4, 1e4}) {
    Skeleton skeleton = dog();
    for (Transform& t : skeleton.reference) t.position *= scale;
    const Body body = build_low(skeleton);
    const Body usual = build_low(dog());
    EXPECT_NEAR(body.volume / (scale * scale * scale * usual.volume), 1, 0.05) << scale;
    EXPECT_TRUE(check(body.model).ok());
  }
}

TEST(GeneralBody, OfBonesThatFoldBackOnThemselves) {
  Skeleton skeleton;
  int joint = add(skeleton, "root", -1, Vec3::Zero());
  for (int i = 0; i < 6; ++i) {
    joint = add(skeleton, "fold" + std::to_string(i), joint, {0, i % 2 ? -0.4 : 0.4, 0});
  }
  expect_valid_body(build_low(skeleton));
}

TEST(GeneralBody, OfVeryUnequalBones) {
  Skeleton skeleton;
  const int root = add(skeleton, "root", -1, Vec3::Zero());
  const int far = add(skeleton, "far", root, {100, 0, 0});
  add(skeleton, "tiny", far, {0, 0.001, 0}, true);
  add(skeleton, "twig", root, {0, 0.01, 0}, true);
  expect_valid_body(build_low(skeleton));
}

TEST(GeneralBody, NumbersOutOfBoundsAreRefused) {
  Skeleton skeleton;
  const int root = add(skeleton, "root", -1, Vec3::Zero());
  add(skeleton, "far", root, {1e15, 0, 0}, true);
  const auto body = make_body(skeleton, {});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().code, "skeleton-value");
  EXPECT_FALSE(make_body(Skeleton(), {}).ok());

  Skeleton crowd;
  for (int j = 0; j <= 2000; ++j) {
    crowd.add("j" + std::to_string(j), j - 1, Transform(), false);
  }
  const auto many = make_body(crowd, {});
  ASSERT_FALSE(many.ok());
  EXPECT_EQ(many.error().code, "body-joints");
}

}  // namespace
}  // namespace krok
