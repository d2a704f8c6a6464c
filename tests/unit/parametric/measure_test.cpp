// If these fail, what a library says of its blends is not what the blended motions do: refinement
// then works towards wrong steps.

#include "parametric/measure.h"

#include <gmock/gmock.h>

#include <random>

#include "core/parallel.h"
#include "motion/hips_root.h"
#include "motion/sample.h"
#include "parametric/blended_motion.h"
#include "walks.h"

namespace krok::parametric {
namespace {

const Library& grid_library(bool turns) {
  static const auto make = [](bool three) {
    std::vector<std::string> parameters = test::kStepParameters;
    parameters.insert(parameters.end(), {"LeftHand.up@swing_off", "Head.along@swing_strike",
                                         "RightHand.across@stance_strike"});
    return test::library_of(test::grid_walks(three), parameters, {.mirror = false, .outlier = 0})
        .library;
  };
  static const Library two = make(false), three = make(true);
  return turns ? three : two;
}

// Weights that sum to 1, some of them negative.
std::vector<double> random_weights(std::mt19937& random, std::size_t count) {
  std::vector<double> weights(count);
  double sum = 0;
  for (double& weight : weights) {
    weight = static_cast<double>(random() % 1000) / 1000 - 0.2;
    sum += weight;
  }
  for (double& weight : weights) weight += (1 - sum) / static_cast<double>(count);
  return weights;
}

TEST(Measure, JacobianIsThatOfCentralDifferences) {
  std::mt19937 random(3);
  for (const bool turns : {false, true}) {
    const Library& library = grid_library(turns);
    const PackedExamples packed = pack_examples(library);
    const Measure measure(library, packed);
    auto scratch = measure.make_scratch();
    const auto n = library.examples.size(), d = library.parameters.size();
    ASSERT_EQ(n, turns ? 27u : 9u);
    for (int round = 0; round < 20; ++round) {
      std::vector<double> weights = random_weights(random, n);
      std::vector<double> values(d), jacobian(d * n), above(d), below(d);
      ASSERT_TRUE(measure(weights, values, jacobian, scratch));
      for (std::size_t i = 0; i < n; ++i) {
        constexpr double kStep = 1e-5;
        const double was = weights[i];
        weights[i] = was + kStep;
        ASSERT_TRUE(measure(weights, above, {}, scratch));
        weights[i] = was - kStep;
        ASSERT_TRUE(measure(weights, below, {}, scratch));
        weights[i] = was;
        for (std::size_t p = 0; p < d; ++p) {
          EXPECT_NEAR(jacobian[p * n + i], (above[p] - below[p]) / (2 * kStep), 2e-8)
              << "parameter " << p << " example " << i;
        }
      }
    }
  }
}

TEST(Measure, AtAnExampleItGivesTheExamplesOwnParameters) {
  const Library& library = grid_library(true);
  const PackedExamples packed = pack_examples(library);
  const Measure measure(library, packed);
  auto scratch = measure.make_scratch();
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    std::vector<double> weights(library.examples.size(), 0), values(library.parameters.size());
    weights[i] = 1;
    ASSERT_TRUE(measure(weights, values, {}, scratch));
    for (std::size_t d = 0; d < values.size(); ++d) {
      EXPECT_NEAR(values[d], library.examples[i].parameters[d], 2e-6);
    }
  }
}

// Place and heading of a foot told from the clip without the library: the heel or, behind the ball,
// where it comes down.
struct Print {
  Vec3 heel;
  double heading;
};
Print print_in(std::span<const Transform> pose, const FootShape& foot) {
  const Transform& ankle = pose[static_cast<std::size_t>(foot.joint)];
  const Vec3 heel = ankle * foot.heel;
  const Vec3 ball = ankle * ball_of(foot);
  const Vec3 way = ball - heel;
  Print print{heel, std::atan2(way.x(), way.z())};
  if (ball.y() < heel.y()) {
    print.heel = ball - foot.length * Vec3(std::sin(print.heading), 0, std::cos(print.heading));
  }
  return print;
}

// The parameters of a made clip by sampling it at its keytimes.
TEST(Measure, IsWhatTheMadeMotionMeasures) {
  std::mt19937 random(5);
  for (const bool turns : {false, true}) {
    const Library& library = grid_library(turns);
    const PackedExamples packed = pack_examples(library);
    const Measure measure(library, packed);
    auto scratch = measure.make_scratch();
    for (int round = 0; round < 10; ++round) {
      const auto weights = random_weights(random, library.examples.size());
      std::vector<double> values(library.parameters.size());
      ASSERT_TRUE(measure(weights, values, {}, scratch));
      const auto motion = BlendedMotion::create(library, packed, weights);
      ASSERT_TRUE(motion.ok()) << motion.error().message;
      auto space = motion->make_scratch();
      const auto pose_at = [&](double time) {
        std::vector<PoseBlock> pose(space.reference.size());
        motion->pose(time, pose, space);
        std::vector<Transform> world(library.skeleton.names.size());
        unpack_pose(pose, world);
        local_to_world(library.skeleton.parents, world, world);
        return world;
      };
      const auto first = pose_at(0), off = pose_at(motion->keytimes()[1]),
                 last = pose_at(motion->duration());
      const Print stance = print_in(first, library.foot(FootSide::right));
      EXPECT_LT(stance.heel.norm(), 2e-6);
      EXPECT_NEAR(stance.heading, 0, 2e-6);
      const Print swing = print_in(last, library.foot(FootSide::left));
      const auto at = [&](const auto& pose, const char* name) {
        return pose[static_cast<std::size_t>(library.skeleton.find(name))].position;
      };
      EXPECT_NEAR(values[0], swing.heel.z(), 5e-6);
      EXPECT_NEAR(values[1], swing.heel.x(), 5e-6);
      EXPECT_NEAR(values[2], swing.heel.y(), 5e-6);
      EXPECT_NEAR(values[3], swing.heading, 5e-6);
      EXPECT_NEAR(values[4], motion->duration(), 1e-12);
      EXPECT_NEAR(values[5], at(off, "LeftHand").y(), 5e-6);
      EXPECT_NEAR(values[6], at(last, "Head").z(), 5e-6);
      EXPECT_NEAR(values[7], at(first, "RightHand").x(), 5e-6);
    }
  }
}

TEST(Measure, SeveralThreadsGetTheSame) {
  const Library& library = grid_library(true);
  const PackedExamples packed = pack_examples(library);
  const Measure measure(library, packed);
  const std::size_t n = library.examples.size(), d = library.parameters.size();
  std::mt19937 random(2);
  std::vector<std::vector<double>> weights, one(200), many(200);
  for (std::size_t i = 0; i < one.size(); ++i) weights.push_back(random_weights(random, n));
  const auto run = [&](std::vector<std::vector<double>>& results, int jobs) {
    parallel_for(results.size(), 7, jobs, [&](std::size_t begin, std::size_t end) {
      auto scratch = measure.make_scratch();
      for (std::size_t i = begin; i < end; ++i) {
        results[i].resize(d + d * n);
        const auto all = std::span(results[i]);
        EXPECT_TRUE(measure(weights[i], all.first(d), all.subspan(d), scratch));
      }
    });
  };
  run(one, 1);
  run(many, 4);
  EXPECT_EQ(one, many);
}

// Mirrored, everything is on the other side, and measures the same.
TEST(Measure, MirroredLibraryMeasuresTheSame) {
  const Library& library = grid_library(true);
  const auto image = mirrored(library);
  ASSERT_TRUE(image.ok()) << image.error().message;
  EXPECT_EQ(image->swing, FootSide::right);
  EXPECT_TRUE(check(*image));
  EXPECT_EQ(name_of(image->parameters[5], image->skeleton, image->keytimes),
            "RightHand.up@swing_off");
  const PackedExamples packed = pack_examples(library), packed_image = pack_examples(*image);
  const Measure measure(library, packed), of_image(*image, packed_image);
  auto scratch = measure.make_scratch(), scratch_image = of_image.make_scratch();
  std::mt19937 random(9);
  for (int round = 0; round < 5; ++round) {
    const auto weights = random_weights(random, library.examples.size());
    std::vector<double> values(library.parameters.size()), mirrored_values(values);
    ASSERT_TRUE(measure(weights, values, {}, scratch));
    ASSERT_TRUE(of_image(weights, mirrored_values, {}, scratch_image));
    for (std::size_t d = 0; d < values.size(); ++d) {
      EXPECT_NEAR(values[d], mirrored_values[d], 5e-6) << d;
    }
  }
}

TEST(Measure, SaysWhenRotationsCancelAndWhenAFootStandsUpright) {
  Library library = grid_library(false);
  library.examples.resize(2);
  library.examples[1] = library.examples[0];
  {
    const PackedExamples packed = pack_examples(library);
    const Measure measure(library, packed);
    auto scratch = measure.make_scratch();
    std::vector<double> values(library.parameters.size());
    const double weights[] = {1, -1};
    const Status status = measure(weights, values, {}, scratch);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, "parametric-sum");
  }
  const Example& example = library.examples[0];
  FootShape& foot = library.feet[0];
  std::vector<Transform> pose(library.skeleton.names.size());
  const PackedExamples packed = pack_examples(library);
  std::vector<PoseBlock> blocks(packed.reference.blocks.size());
  // The sole points where the foot's up is at the last keytime.
  std::vector<Transform> space(3 * pose.size());
  sample(example.motion, example.keytimes.back(), pose, space);
  foot.forward = pose[static_cast<std::size_t>(foot.joint)].orientation.conjugate() * Vec3::UnitY();
  const Measure measure(library, packed);
  auto scratch = measure.make_scratch();
  std::vector<double> values(library.parameters.size());
  const double weights[] = {1, 0};
  const Status status = measure(weights, values, {}, scratch);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "parametric-foot");
}

}  // namespace
}  // namespace krok::parametric
