// The human body: if these fail, a capture of a person no longer comes out as a closed, bound,
// person-shaped mesh.

#include <algorithm>

#include "core/index.h"
#include "math/quaternion.h"
#include "support/human_skeleton.h"
#include "unit/body/mesh_checks.h"

namespace krok {
namespace {

using test::build;
using test::expect_valid_body;
using test::human_skeleton;

// The usual body, built once for all tests that look at it.
const Body& usual() {
  static const Body body = build(human_skeleton());
  return body;
}

// Turns the joints below and including `joint` about it.
void turn(Skeleton& skeleton, const std::string& joint, const Quat& rotation) {
  const auto at = static_cast<std::size_t>(skeleton.find(joint));
  const Vec3 pivot = skeleton.reference[at].position;
  std::vector<char> below(skeleton.names.size(), 0);
  for (std::size_t j = at; j < below.size(); ++j) {
    const int parent = skeleton.parents[j];
    below[j] = j == at || (parent >= 0 && below[static_cast<std::size_t>(parent)]);
    if (!below[j]) continue;
    auto& t = skeleton.reference[j];
    t.position = pivot + rotation * (t.position - pivot);
    t.orientation = rotation * t.orientation;
  }
}

// The extent of the body along x (axis 0) or z (axis 2) at a height, vertices within 2 cm of it and
// within `reach` of x = 0.
double extent_at(const Model& model, double height, int axis, double reach) {
  double low = 1e9, high = -1e9;
  for (const Vec3f& p : model.positions) {
    if (std::abs(p.y() - height) > 0.02 || std::abs(p.x()) > reach) continue;
    low = std::min<double>(low, p[axis]);
    high = std::max<double>(high, p[axis]);
  }
  return high - low;
}

TEST(HumanBody, IsAClosedBoundSphereTurnedOutward) {
  const Body& body = usual();
  expect_valid_body(body);
  EXPECT_TRUE(body.human);
  EXPECT_EQ(body.pose, "reference");
  EXPECT_NEAR(body.stature, 1.75, 0.1);
}

TEST(HumanBody, HasTheVolumeOfAPerson) {
  const Body& body = usual();
  EXPECT_GT(body.volume, 0.05);
  EXPECT_LT(body.volume, 0.11);
  // And grows with the cube of the stature.
  const Body small = build(human_skeleton(0.875), {.detail = BodyDetail::low});
  EXPECT_NEAR(small.volume * 8 / body.volume, 1, 0.04);
}

TEST(HumanBody, DetailSetsTheNumberOfVertices) {
  const std::pair<BodyDetail, int> levels[] = {{BodyDetail::preview, 1200},
                                               {BodyDetail::low, 2500},
                                               {BodyDetail::medium, 10000},
                                               {BodyDetail::high, 40000}};
  for (const auto& [detail, vertices] : levels) {
    const Body body = build(human_skeleton(), {.detail = detail});
    expect_valid_body(body);
    EXPECT_GT(body.model.vertex_count(), 0.85 * vertices);
    EXPECT_LT(body.model.vertex_count(), 1.15 * vertices);
  }
}

TEST(HumanBody, HasTheProportionsOfAPerson) {
  const Model& model = usual().model;
  Eigen::AlignedBox3f box;
  for (const Vec3f& p : model.positions) box.extend(p);
  EXPECT_NEAR(box.sizes().y(), 1.75, 0.06);  // as tall as its skeleton
  EXPECT_NEAR(box.min().y(), 0, 0.02);       // stands on the ground
  EXPECT_NEAR(box.sizes().x(), 1.75, 0.15);  // arm span about the stature
  // Chest, waist and hips are wider than deep; the waist is the narrowest.
  const double chest = extent_at(model, 1.30, 0, 0.19), waist = extent_at(model, 1.13, 0, 0.3),
               hips = extent_at(model, 0.94, 0, 0.3);
  EXPECT_GT(chest, 1.2 * extent_at(model, 1.30, 2, 0.19));
  EXPECT_GT(waist, 1.2 * extent_at(model, 1.13, 2, 0.3));
  EXPECT_GT(hips, 1.2 * extent_at(model, 0.94, 2, 0.3));
  EXPECT_LT(waist, chest);
  EXPECT_LT(waist, hips);
  // Toes point forward, the soles are flat: many vertices lie on the ground.
  EXPECT_GT(box.max().z(), 0.15);
  const auto on_ground = std::count_if(model.positions.begin(), model.positions.end(),
                                       [&](auto& p) { return p.y() < box.min().y() + 0.004f; });
  EXPECT_GT(on_ground, 100);
  // The thighs are apart above the knees.
  const bool gap = std::none_of(model.positions.begin(), model.positions.end(), [](auto& p) {
    return p.y() > 0.5f && p.y() < 0.75f && std::abs(p.x()) < 0.004f;
  });
  EXPECT_TRUE(gap);
}

TEST(HumanBody, IsNearlyMirrorSymmetric) {
  const Model& model = usual().model;
  // Each vertex has the mirrored surface close by: within an edge length of some vertex.
  double worst = 0, sum = 0;
  std::size_t tried = 0;
  for (std::size_t v = 0; v < model.positions.size(); v += 7) {
    const Vec3f mirrored(-model.positions[v].x(), model.positions[v].y(), model.positions[v].z());
    double nearest = 1e9;
    for (std::size_t u = 0; u < model.positions.size(); ++u) {
      // Distance to the tangent plane for vertices close by.
      const Vec3f offset = mirrored - model.positions[u];
      if (offset.norm() > 0.03f) continue;
      nearest = std::min<double>(nearest, std::abs(offset.dot(model.normals[u])));
    }
    worst = std::max(worst, nearest);
    sum += nearest;
    ++tried;
  }
  EXPECT_LT(worst, 0.005);
  EXPECT_LT(sum / static_cast<double>(tried), 0.0005);
}

// Hands with fingers and, at the wrist, joints of bones without length, as props have them: these
// hold no flesh, and no vertex beyond the middle follows a joint of the other side.
TEST(HumanBody, IsBoundToBonesOfItsOwnSide) {
  Skeleton skeleton = human_skeleton();
  for (const double sign : {1.0, -1.0}) {
    const std::string side = sign > 0 ? "Left" : "Right";
    const int hand = skeleton.find(side + "Hand");
    const auto add = [&](const std::string& name, int parent, const Vec3& offset,
                         bool end = false) {
      Transform place = skeleton.reference[static_cast<std::size_t>(parent)];
      place.position += Vec3(sign * offset.x(), offset.y(), offset.z());
      return skeleton.add(side + name, parent, place, end);
    };
    for (int finger = 0; finger < 4; ++finger) {
      const std::string name = "HandFinger" + std::to_string(finger);
      const int knuckle = add(name, hand, {0.09, 0, 0.03 - 0.02 * finger});
      add(name + "_end", add(name + "b", knuckle, {0.03, 0, 0}), {0.025, 0, 0}, true);
    }
    const int still = add("Hand_x", hand, Vec3::Zero());
    add("Hand_x_end", still, Vec3::Zero(), true);
  }
  const Body body = build(skeleton, {.detail = BodyDetail::low});
  expect_valid_body(body);
  ASSERT_TRUE(body.human);
  for (std::size_t v = 0; v < body.model.positions.size(); ++v) {
    double other = 0;
    const float x = body.model.positions[v].x();
    for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
      const std::string& name = skeleton.names[body.model.influence_joints[k]];
      if (name.starts_with(x > 0 ? "Right" : "Left")) other += body.model.influence_weights[k];
      EXPECT_EQ(name.find("Hand_x"), std::string::npos);
    }
    EXPECT_LT(other, std::abs(x) > 0.15f ? 1e-6 : 0.5) << body.model.positions[v].transpose();
  }
}

// An animal whose joints have a person's names, on its legs or, as a reader may stand it up, not.
TEST(HumanBody, IsNotGivenToAnimalsOnFourLegs) {
  Skeleton animal = human_skeleton();
  for (const std::string side : {"Left", "Right"}) {
    turn(animal, side + "UpLeg", from_rotation_vector(Vec3(-kPi / 2, 0, 0)));
    turn(animal, side + "Arm", shortest_arc(Vec3(side == "Left" ? 1 : -1, 0, 0), Vec3::UnitZ()));
  }
  EXPECT_FALSE(build(animal, {.detail = BodyDetail::low}).human);
  turn(animal, "Hips", from_rotation_vector(Vec3(kPi / 2, 0, 0)));
  EXPECT_FALSE(build(animal, {.detail = BodyDetail::low}).human);
}

TEST(HumanBody, EachPartFollowsItsOwnJoint) {
  const Skeleton skeleton = human_skeleton();
  const Model& model = usual().model;
  const auto weight_of = [&](std::size_t v, const std::string& joint) {
    double sum = 0;
    for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
      if (skeleton.names[model.influence_joints[k]] == joint) sum += model.influence_weights[k];
    }
    return sum;
  };
  int fingertips = 0, shins = 0;
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const Vec3f& p = model.positions[v];
    if (p.x() > 0.82f) {
      ++fingertips;
      EXPECT_GT(weight_of(v, "LeftHand"), 0.95);
    }
    if (p.x() < -0.55f && p.x() > -0.68f && p.y() > 1.2f) {
      EXPECT_GT(weight_of(v, "RightForeArm"), 0.8);
    }
    if (p.y() < 0.35f && p.y() > 0.2f && p.x() > 0) {
      ++shins;
      EXPECT_GT(weight_of(v, "LeftLeg"), 0.9);
    }
    if (p.y() > 1.65f) {
      EXPECT_GT(weight_of(v, "Head"), 0.9);
    }
    // Nothing on the left moves with the right arm or leg, and the other way round.
    if (p.x() > 0.10f) {
      EXPECT_EQ(weight_of(v, "RightArm") + weight_of(v, "RightUpLeg"), 0);
    }
  }
  EXPECT_GT(fingertips, 20);
  EXPECT_GT(shins, 20);
}

TEST(HumanBody, WeightsChangeGraduallyAlongTheSurface) {
  const Skeleton skeleton = human_skeleton();
  const Model& model = usual().model;
  std::vector<std::map<int, double>> weights(model.positions.size());
  for (std::size_t v = 0; v < weights.size(); ++v) {
    for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
      weights[v][model.influence_joints[k]] += model.influence_weights[k];
    }
  }
  double worst = 0;
  for (const auto& t : model.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      auto difference = weights[t[k]];
      for (const auto& [joint, weight] : weights[t[(k + 1) % 3]]) difference[joint] -= weight;
      for (const auto& [joint, weight] : difference) worst = std::max(worst, std::abs(weight));
    }
  }
  EXPECT_LT(worst, 0.5);
}

TEST(HumanBody, HangingArmsAreTurnedAsideAndNotBoundToTheTrunk) {
  Skeleton skeleton = human_skeleton();
  turn(skeleton, "LeftArm", Quat(Eigen::AngleAxisd(-1.5, Vec3::UnitZ())));
  turn(skeleton, "RightArm", Quat(Eigen::AngleAxisd(1.5, Vec3::UnitZ())));
  const Body body = build(skeleton);
  expect_valid_body(body);
  EXPECT_EQ(body.pose, "reference, limbs turned aside");
  // Bones keep their lengths, and the model is bound where it says.
  const auto hand = static_cast<std::size_t>(skeleton.find("LeftHand"));
  EXPECT_GT(body.model.skeleton.reference[hand].position.x(), 0.4);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    EXPECT_NEAR(
        (body.model.skeleton.reference_local(j).position - skeleton.reference_local(j).position)
            .norm(),
        0, 1e-9);
  }
  // Asked for, the reference pose itself.
  const Body asked = build(skeleton, {.detail = BodyDetail::low, .pose = BodyPose::reference});
  expect_valid_body(asked);
  EXPECT_EQ(asked.pose, "reference");
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    EXPECT_EQ(asked.model.skeleton.reference[j].position, skeleton.reference[j].position);
  }
}

TEST(HumanBody, AReferencePoseThatIsNoneGivesWayToATPose) {
  // All bones along +Y, as some exporters write them; the motion holds a T-pose.
  const Skeleton posed = human_skeleton();
  Clip clip;
  clip.skeleton = posed;
  for (int j = 1; j < posed.joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    const int parent = posed.parents[i];
    auto& reference = clip.skeleton.reference;
    reference[i].position = reference[static_cast<std::size_t>(parent)].position +
                            Vec3(0, posed.reference_local(j).position.norm(), 0);
  }
  clip.resize(3);
  for (int frame = 0; frame < 3; ++frame) clip.set_pose(frame, posed.reference);
  const auto body = make_body(clip, {.detail = BodyDetail::low});
  ASSERT_TRUE(body.ok());
  EXPECT_TRUE(body->human);
  expect_valid_body(*body);
  EXPECT_EQ(body->pose, "T-pose built from the skeleton");
  for (std::size_t j = 0; j < posed.names.size(); ++j) {
    const Vec3 place = body->model.skeleton.reference[j].position;
    EXPECT_LT((place - posed.reference[j].position).norm(), 0.05) << posed.names[j];
  }
}

// An exporter's reference pose that has the collar bones half round about themselves against every
// frame. Would fail if the skin around them were wrung all the time: shoulders came out as holes.
TEST(HumanBody, CollarBonesHalfRoundInEveryFrameDoNotWringTheSkin) {
  Clip clip;
  clip.skeleton = human_skeleton();
  const auto collar = static_cast<std::size_t>(clip.skeleton.find("LeftShoulder"));
  clip.resize(3);
  const Quat half_round = from_rotation_vector(Vec3(kPi - 0.1, 0, 0));  // along the bone
  for (int f = 0; f < 3; ++f) {
    clip.set_pose(f, clip.skeleton.reference);
    clip.frame_orientations(f)[collar] = half_round.cast<float>();
  }
  const Body body = make_body(clip, {.detail = BodyDetail::low}).value();
  EXPECT_LT(angle_between(body.model.skeleton.reference[collar].orientation, half_round), 0.2);
  expect_valid_body(body);
  // Asked for in the reference pose, the skin is whole there.
  const Body there =
      make_body(clip, {.detail = BodyDetail::low, .pose = BodyPose::reference}).value();
  const Body usual = build(human_skeleton(), {.detail = BodyDetail::low});
  EXPECT_NEAR(there.volume, usual.volume, 1e-6);
}

TEST(HumanBody, AFootThatHangsOnAJointUnderTheAnkleStaysLevel) {
  // From the ankle straight down to the sole, from there to the tip: no ball of the foot.
  Skeleton skeleton = human_skeleton();
  for (const std::string side : {"Left", "Right"}) {
    const auto foot = static_cast<std::size_t>(skeleton.find(side + "Foot"));
    const auto toes = static_cast<std::size_t>(skeleton.find(side + "ToeBase"));
    skeleton.reference[toes].position = skeleton.reference[foot].position - Vec3(0, 0.04, 0);
    Transform tip = skeleton.reference[toes];
    tip.position.z() += 0.2;
    skeleton.add(side + "Tip", static_cast<int>(toes), tip, true);
  }
  const Body body = build(skeleton, {.detail = BodyDetail::low});
  expect_valid_body(body);
  EXPECT_EQ(body.pose, "reference");  // nothing was turned
  const int carrier = skeleton.find("LeftToeBase");
  bool carried = false;
  for (std::size_t v = 0; v < body.model.positions.size(); ++v) {
    const Vec3f& p = body.model.positions[v];
    carried = carried || (p.z() > 0.1f && p.x() > 0 && p.y() < 0.08f &&
                          body.model.influence_joints[4 * v] == carrier);
  }
  EXPECT_TRUE(carried);
}

// Would fail if a leg that ends in a point below the ankle got a foot that hangs straight down.
TEST(HumanBody, ALegThatEndsBelowItsAnkleHasALevelFoot) {
  const Skeleton human = human_skeleton();
  Clip clip;
  for (int j = 0; j < human.joint_count(); ++j) {
    const std::string& name = human.names[at(j)];
    Transform place = human.reference[at(j)];
    if (name.ends_with("ToeBase_end")) continue;
    const bool end = name.ends_with("ToeBase");
    if (end) place.position = clip.skeleton.reference.back().position - Vec3(0, 0.08, 0);
    const int parent = human.parents[at(j)];
    clip.skeleton.add(end ? name + "_end" : name,
                      parent < 0 ? -1 : clip.skeleton.find(human.names[at(parent)]), place,
                      human.end_sites[at(j)] != 0 || end);
  }
  clip.resize(1);
  clip.set_pose(0, clip.skeleton.reference);
  const Model model = make_body(clip, {.detail = BodyDetail::low}).value().model;
  const auto ankle = static_cast<std::size_t>(model.skeleton.find("LeftFoot"));
  const Quat turn = model.skeleton.reference[ankle].orientation *
                    clip.skeleton.reference[ankle].orientation.conjugate();
  EXPECT_LT(angle_between(turn, Quat::Identity()), 0.3);
  EXPECT_GT(extent_at(model, 0.02, 2, 0.5), 0.2);
}

TEST(HumanBody, TheNumberOfThreadsDoesNotMatter) {
  const Body one = build(human_skeleton(), {.jobs = 1}),
             three = build(human_skeleton(), {.jobs = 3});
  EXPECT_EQ(one.model.positions, three.model.positions);
  EXPECT_EQ(one.model.normals, three.model.normals);
  EXPECT_EQ(one.model.texture_coordinates, three.model.texture_coordinates);
  EXPECT_EQ(one.model.triangles, three.model.triangles);
  EXPECT_EQ(one.model.influence_joints, three.model.influence_joints);
  EXPECT_EQ(one.model.influence_weights, three.model.influence_weights);
}

TEST(HumanBody, AFrameThatIsNotThereIsAnError) {
  const auto body = make_body(human_skeleton(), {.pose = BodyPose::frame, .frame = 3});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.error().code, "body-frame");
}

}  // namespace
}  // namespace krok
