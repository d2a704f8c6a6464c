// Would fail if a corrective missed its sculpt, blended badly between examples, changed with where
// the body stands or how many threads work, or if bad examples were taken.

#include "correctives/correctives.h"

#include <gtest/gtest.h>

#include <random>

#include "bent_tube.h"
#include "formats/correctives/correctives_format.h"
#include "skin/morph.h"

namespace krok::test {
namespace {

constexpr double kDegree = kRadiansPerDegree;

SculptedJoint elbow(const Model& tube, std::initializer_list<double> examples,
                    const Vec3& axis = Vec3::UnitZ()) {
  SculptedJoint joint;
  joint.joint = 1;
  for (const double angle : examples) {
    joint.examples.push_back(sculpted(tube, axis * (angle * kDegree)));
  }
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    const double angle = 3 + static_cast<double>(random() % 10001) * 0.0132;
    joint.held_out.push_back(sculpted(tube, axis * (angle * kDegree)));
  }
  return joint;
}

// Mean error of held-out poses over that of plain skinning.
double share(const std::vector<PoseError>& errors) {
  double skinned = 0, corrected = 0;
  for (const PoseError& error : errors) {
    if (!error.held_out) continue;
    skinned += error.skinned.root_mean_square;
    corrected += error.corrected.root_mean_square;
  }
  return corrected / skinned;
}

TEST(Correctives, SwingAndTwistAreFourTimesTheTangentOfAQuarterAngle) {
  const Vec3 axis = Vec3(1, 2, -1).normalized(), across = axis.cross(Vec3::UnitY()).normalized();
  const Quat reference = from_rotation_vector(Vec3(0.4, 0.1, -0.9));
  for (const double swing : {0.0, 0.7, 2.0, 3.0}) {
    for (const double twist : {0.0, -1.2, 2.9}) {
      const Quat q =
          reference * from_rotation_vector(swing * across) * from_rotation_vector(twist * axis);
      const Vec3 expected = 4 * std::tan(swing / 4) * across + 4 * std::tan(twist / 4) * axis;
      EXPECT_LT((swing_and_twist(axis, reference, q) - expected).norm(), 1e-12);
      Quat other = q;
      other.coeffs() = -q.coeffs();
      EXPECT_LT((swing_and_twist(axis, reference, other) - expected).norm(), 1e-12);
    }
  }
  // A swing of half a turn leaves the twist open: 0.
  const Vec3 half = swing_and_twist(axis, Quat::Identity(), from_rotation_vector(kPi * across));
  EXPECT_NEAR(half.norm(), 4, 1e-9);
  EXPECT_NEAR(half.dot(axis), 0, 1e-9);
}

TEST(Correctives, FiveExamplesOfAHingeMeetTheSculptBetweenThem) {
  const Model tube = bent_tube();
  const auto fit = fit_correctives(tube, SkinMethod::linear, {elbow(tube, {30, 60, 90, 115, 135})});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_LT(share(fit->errors[0]), 0.02);
  for (const PoseError& error : fit->errors[0]) {
    if (error.held_out) continue;
    EXPECT_LT(error.corrected.largest, 0.005 * error.skinned.largest + 3e-6);
  }
  EXPECT_EQ(fit->correctives.joints[0].directions.size(), 1u);
}

TEST(Correctives, FiveExamplesOfTwoDirectionsStayBelowATenth) {
  const Model tube = bent_tube();
  SculptedJoint joint;
  joint.joint = 1;
  const auto swing = [&](double a, double b) {
    return sculpted(tube, Vec3(0, a * kDegree, b * kDegree));
  };
  joint.examples = {swing(60, 0), swing(-30, 40), swing(60, 80), swing(-10, 80), swing(30, 45)};
  std::mt19937 random(6);
  for (int i = 0; i < 20; ++i) {
    const double a = -30 + static_cast<double>(random() % 9001) / 100;
    joint.held_out.push_back(swing(a, static_cast<double>(random() % 8001) / 100));
  }
  const auto fit = fit_correctives(tube, SkinMethod::linear, {joint});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(fit->correctives.joints[0].directions.size(), 2u);
  EXPECT_TRUE(fit->correctives.joints[0].squares);
  EXPECT_LT(share(fit->errors[0]), 0.1);
}

TEST(Correctives, RefinementTakesTheWorstHeldOutPose) {
  const Model tube = bent_tube();
  const auto before = fit_correctives(tube, SkinMethod::linear, {elbow(tube, {60, 135})});
  const auto after =
      fit_correctives(tube, SkinMethod::linear, {elbow(tube, {60, 135})}, {.refine = 3});
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->refined[0], 3);
  EXPECT_EQ(after->correctives.joints[0].target_count(), 5);
  EXPECT_LT(share(after->errors[0]), 0.3 * share(before->errors[0]));
  const auto bounded = fit_correctives(tube, SkinMethod::linear, {elbow(tube, {60, 135})},
                                       {.refine = 3, .max_error = 1});
  EXPECT_EQ(bounded->refined[0], 0);
}

TEST(Correctives, WeightsAreThoseOfExamplesWhereverTheBodyStands) {
  const Model tube = bent_tube();
  const auto fit = fit_correctives(tube, SkinMethod::linear, {elbow(tube, {40, 80, 120})});
  const auto weights = CorrectiveWeights::create(fit->correctives, tube.skeleton);
  ASSERT_TRUE(weights);
  const Transform place{Vec3(3, -1, 2), from_rotation_vector(Vec3(1, 2, 0.3))};
  const auto at = [&](double angle) {
    std::vector<Transform> pose = bent(tube, Vec3(0, 0, angle * kDegree));
    for (Transform& joint : pose) joint = place * joint;
    std::vector<float> found(3);
    weights->at(pose, found);
    return found;
  };
  for (const float weight : at(0)) EXPECT_NEAR(weight, 0, 1e-6);
  for (int i = 0; i < 3; ++i) {
    const auto found = at(40 * (i + 1));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[static_cast<std::size_t>(k)], i == k, 1e-5);
  }
  // Beyond the examples as at the last.
  EXPECT_NEAR(at(170)[2], 1, 1e-5);
  EXPECT_NEAR(at(-90)[1], 0, 1e-5);
}

TEST(Correctives, TargetsAddedBeforeSkinningGiveTheSculpt) {
  const Model tube = bent_tube();
  SculptedJoint joint = elbow(tube, {50, 100});
  for (SculptedPose& pose : joint.examples) {  // normals of dual quaternion skinning
    const SkinBinding binding(tube, SkinMethod::dual_quaternion);
    SkinPose posed(binding);
    posed.set(pose.joint_to_world);
    pose.normals.resize(tube.normals.size());
    skin(binding, posed, {tube.positions, tube.normals, {}}, {pose.positions, pose.normals, {}});
  }
  const auto fit = fit_correctives(tube, SkinMethod::linear, {joint});
  ASSERT_TRUE(fit);
  const MorphSet targets = targets_of(fit->correctives, tube);
  EXPECT_TRUE(check(targets)) << check(targets).error().message;
  const auto weights = CorrectiveWeights::create(fit->correctives, tube.skeleton);
  std::vector<float> found(2);
  weights->at(joint.examples[1].joint_to_world, found);
  std::vector<Vec3f> positions(tube.positions.size()), normals(positions.size());
  apply_morphs(targets, found, {tube.positions, tube.normals}, {positions, normals});
  const SkinBinding binding(tube, SkinMethod::linear);
  SkinPose posed(binding);
  posed.set(joint.examples[1].joint_to_world);
  std::vector<Vec3f> moved(positions.size()), turned(positions.size());
  skin(binding, posed, {positions, normals, {}}, {moved, turned, {}});
  for (std::size_t v = 0; v < moved.size(); ++v) {
    EXPECT_LT((moved[v] - joint.examples[1].positions[v]).norm(), 5e-5f);
    EXPECT_LT((turned[v] - joint.examples[1].normals[v]).norm(), 5e-3f);
  }
}

TEST(Correctives, ThreadsDoNotChangeThem) {
  const Model tube = bent_tube();
  const auto joint = elbow(tube, {30, 60, 90});
  const auto one = fit_correctives(tube, SkinMethod::linear, {joint}, {.jobs = 1});
  const auto three = fit_correctives(tube, SkinMethod::linear, {joint}, {.jobs = 3});
  EXPECT_EQ(*correctives_file::write(one->correctives),
            *correctives_file::write(three->correctives));
}

TEST(Correctives, LaterJointsAddOnlyWhatEarlierOnesLeave) {
  const Model tube = bent_tube();
  SculptedJoint first = elbow(tube, {60, 120}), again = first;
  first.held_out.clear();
  again.joint = 0;  // does not turn
  const auto fit = fit_correctives(tube, SkinMethod::linear, {first, again});
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, "correctives-examples");
  EXPECT_EQ(fit.error().joint, "upper");
}

TEST(Correctives, RefuseBadExamples) {
  const Model tube = bent_tube();
  const auto code = [&](const SculptedJoint& joint) {
    const auto fit = fit_correctives(tube, SkinMethod::linear, {joint});
    return fit ? std::string("none") : fit.error().code;
  };
  SculptedJoint joint;
  joint.joint = 1;
  EXPECT_EQ(code(joint), "correctives-examples");
  EXPECT_EQ(code(elbow(tube, {1, 2})), "correctives-examples");
  EXPECT_EQ(code(elbow(tube, {60, 60})), "rbf-duplicate");
  joint = elbow(tube, {60});
  joint.held_out[3].positions.pop_back();
  EXPECT_EQ(code(joint), "correctives-vertices");
}

TEST(Correctives, AreTheSameFromAFile) {
  const Model tube = bent_tube();
  const auto fit = fit_correctives(tube, SkinMethod::linear, {elbow(tube, {30, 90})});
  const auto text = correctives_file::write(fit->correctives);
  ASSERT_TRUE(text) << text.error().message;
  const auto read = correctives_file::read(*text);
  ASSERT_TRUE(read) << read.error().message << read.error().where.line;
  EXPECT_EQ(*correctives_file::write(*read), *text);
  EXPECT_EQ(read->joints[0].weights, fit->correctives.joints[0].weights);
  EXPECT_EQ(read->joints[0].offsets, fit->correctives.joints[0].offsets);
  // Any cut is an error, with a line.
  for (std::size_t cut = 0; cut + 2 < text->size(); cut += text->size() / 50 + 1) {
    const auto damaged = correctives_file::read(text->substr(0, cut));
    ASSERT_FALSE(damaged);
    EXPECT_GT(damaged.error().where.line, 0);
  }
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string other = *text;
    other.replace(other.find(from), from.size(), to);
    const auto result = correctives_file::read(other);
    return result ? std::string("none") : result.error().code;
  };
  EXPECT_EQ(refused("\"vertices\": [", "\"vertices\": [4, 4, "), "correctives-value");
  EXPECT_EQ(refused("\"vertices\": " + std::to_string(tube.vertex_count()), "\"vertices\": 3"),
            "correctives-shape");
  EXPECT_EQ(refused("\"squares\": true", "\"squares\": false"), "correctives-shape");
}

TEST(CorrectivePoses, AreReadWithThePlacesOfMistakes) {
  const std::string text = R"({"schema": "krok.corrective-poses/1", "model": "hero.model",
 "joints": [{"joint": "Elbow", "examples": [
   {"motion": "poses.anim", "frame": 3, "shape": "bent.obj"}]}]})";
  const auto read = corrective_poses::read(text);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->joints[0].examples[0].frame, 3);
  EXPECT_EQ(read->joints[0].examples[0].place.line, 3);
  EXPECT_EQ(read->method, SkinMethod::linear);
  const auto line = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    const auto result = corrective_poses::read(other);
    return result ? -1 : result.error().where.line;
  };
  EXPECT_EQ(line("hero.model", "../hero.model"), 1);
  EXPECT_EQ(line("\"examples\": [", "\"examples\": [], \"held_out\": ["), 2);
  EXPECT_EQ(line("\"frame\": 3", "\"frame\": -3"), 3);
  EXPECT_EQ(line("\"shape\"", "\"form\""), 3);
}

}  // namespace
}  // namespace krok::test
