// If these fail, examples do not come back from a library as they went in, or blends of them are
// out of step, off their stance foot, or not smooth.

#include "parametric/blended_motion.h"

#include <gmock/gmock.h>

#include "motion/sample.h"
#include "pose/packed_pose.h"
#include "walks.h"

namespace krok::parametric {
namespace {

using testing::ElementsAre;

const Library& library() {
  static const Library made =
      test::library_of(test::grid_walks(false), test::kStepParameters, {.mirror = false}).library;
  return made;
}
const PackedExamples& packed() {
  static const PackedExamples made = pack_examples(library());
  return made;
}

std::vector<double> unit_weights(std::size_t example) {
  std::vector<double> weights(library().examples.size(), 0);
  weights[example] = 1;
  return weights;
}

std::vector<double> equal_weights() {
  const auto count = library().examples.size();
  return std::vector<double>(count, 1.0 / static_cast<double>(count));
}

std::vector<Transform> world_at(const BlendedMotion& motion, double time) {
  auto scratch = motion.make_scratch();
  std::vector<PoseBlock> pose(scratch.reference.size());
  motion.pose(time, pose, scratch);
  std::vector<Transform> world(library().skeleton.names.size());
  unpack_pose(pose, world);
  local_to_world(library().skeleton.parents, world, world);
  return world;
}

TEST(BlendedMotion, ExamplesComeBackWithinAHundredthOfAMillimetre) {
  for (std::size_t i = 0; i < library().examples.size(); ++i) {
    const Example& example = library().examples[i];
    const auto motion = BlendedMotion::create(library(), packed(), unit_weights(i));
    ASSERT_TRUE(motion.ok());
    EXPECT_NEAR(motion->duration(), example.keytimes.back() - example.keytimes.front(), 1e-12);
    std::vector<Transform> expected(library().skeleton.names.size()), space(3 * expected.size());
    double largest = 0;
    for (int f = static_cast<int>(std::ceil(example.keytimes.front() * example.motion.rate));
         f <= example.keytimes.back() * example.motion.rate; ++f) {
      const double time = f / example.motion.rate;
      sample(example.motion, time, expected, space);
      const auto found = world_at(*motion, time - example.keytimes.front());
      for (std::size_t j = 0; j < found.size(); ++j) {
        largest = std::max(largest, (found[j].position - expected[j].position).norm());
      }
    }
    EXPECT_LT(largest, 1e-5) << example.name;
  }
}

TEST(BlendedMotion, KeytimesAreTheWeightedSumsOfTheExamples) {
  const auto weights = equal_weights();
  const auto motion = BlendedMotion::create(library(), packed(), weights);
  ASSERT_TRUE(motion.ok());
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0;
    for (const Example& example : library().examples) {
      sum += (example.keytimes[k] - example.keytimes[0]) / static_cast<double>(weights.size());
    }
    EXPECT_NEAR(motion->keytimes()[k], sum, 1e-12);
    EXPECT_NEAR(motion->generic_at(motion->keytimes()[k]), packed().generic[k], 1e-9);
  }
  EXPECT_EQ(motion->generic_at(-1), 0);
  EXPECT_EQ(motion->generic_at(9), packed().generic.back());
  EXPECT_EQ(motion->generic_at(std::nan("")), 0);
}

// Generic time rises, without jumps in its speed.
TEST(BlendedMotion, TimeRunsSmoothly) {
  const auto motion = BlendedMotion::create(library(), packed(), equal_weights());
  ASSERT_TRUE(motion.ok());
  constexpr int kSteps = 2000;
  double before = 0, speed_before = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double generic = motion->generic_at(motion->duration() * i / kSteps);
    const double speed = (generic - before) * kSteps;
    EXPECT_GT(speed, 0);
    if (i > 1) {
      EXPECT_NEAR(speed, speed_before, 0.02 * speed) << i;
    }
    before = generic;
    speed_before = speed;
  }
}

// Half-way between steps of two lengths lies the middle length, but for what rotations do to it.
TEST(BlendedMotion, HalfOfTwoLengthsIsTheMiddleLength) {
  std::vector<double> weights(library().examples.size(), 0);
  weights[1] = weights[7] = 0.5;  // the shortest and the longest on the level
  const auto motion = BlendedMotion::create(library(), packed(), weights);
  ASSERT_TRUE(motion.ok());
  const FootShape& foot = library().foot(FootSide::left);
  const auto last = world_at(*motion, motion->duration());
  const Footprint print = footprint(foot, last[static_cast<std::size_t>(foot.joint)]);
  const double middle =
      (library().examples[1].parameters[0] + library().examples[7].parameters[0]) / 2;
  EXPECT_NEAR(print.place.z(), middle, 0.02);
  EXPECT_GT(std::abs(library().examples[7].parameters[0] - middle), 0.1);
}

TEST(BlendedMotion, MakesAClipThatEndsWithTheStrike) {
  const auto motion = BlendedMotion::create(library(), packed(), equal_weights());
  ASSERT_TRUE(motion.ok());
  const auto made = motion->make();
  ASSERT_TRUE(made.ok());
  EXPECT_TRUE(check(made->clip));
  EXPECT_TRUE(check(made->keys, made->clip.skeleton, made->clip.duration()));
  // As near to the library's rate as the exact duration allows.
  EXPECT_NEAR(made->clip.duration(), motion->duration(), 1e-9);
  EXPECT_NEAR(made->clip.rate, library().rate, 0.5 / motion->duration());
  const auto at_rate = motion->make(library().rate);
  ASSERT_TRUE(at_rate.ok());
  EXPECT_EQ(at_rate->clip.rate, library().rate);
  EXPECT_EQ(at_rate->clip.frame_count(), made->clip.frame_count());
  EXPECT_NEAR(at_rate->clip.duration(), motion->duration(), 0.5 / library().rate);
  ASSERT_EQ(made->keys.keytimes.size(), 3u);
  EXPECT_EQ(made->keys.keytimes[0].name, "right_strike");
  EXPECT_EQ(made->keys.keytimes[1].name, "left_off");
  EXPECT_EQ(made->keys.keytimes[2].name, "left_strike");
  EXPECT_NEAR(made->keys.keytimes[2].time, made->clip.duration(), 1e-9);
  // The frames are the poses at their times.
  const double stretch = made->clip.duration() / motion->duration();
  for (const int frame : {0, 7, 16, made->clip.frame_count() - 1}) {
    const auto expected = world_at(*motion, frame / made->clip.rate / stretch);
    for (std::size_t j = 0; j < expected.size(); ++j) {
      const Vec3 found = made->clip.frame_positions(frame)[j].cast<double>();
      EXPECT_LT((found - expected[j].position).norm(), 2e-6);
    }
  }
  const auto within = motion->make(50, LastFrame::within);
  ASSERT_TRUE(within.ok());
  EXPECT_LE(within->clip.duration(), motion->duration() + 1e-6);
  EXPECT_GT(within->clip.duration(), motion->duration() - 1.0 / 50);
}

// What stands in all examples stands in the blend.
TEST(BlendedMotion, HasTheContactsThatItsExamplesShare) {
  const auto motion = BlendedMotion::create(library(), packed(), unit_weights(4));
  const auto made = motion->make();
  ASSERT_TRUE(made.ok());
  const auto& contacts = library().examples[4].contacts;
  ASSERT_FALSE(contacts.empty());
  ASSERT_EQ(made->keys.contacts.size(), contacts.size());
  for (const Contact& contact : contacts) {
    const bool found = std::ranges::any_of(made->keys.contacts, [&](const Contact& c) {
      return c.joint == contact.joint && (c.place - contact.place).norm() < 1e-5 &&
             std::abs(c.start - contact.start) < 0.02 && std::abs(c.end - contact.end) < 0.02;
    });
    EXPECT_TRUE(found) << contact.joint << " at " << contact.start;
  }
}

TEST(BlendedMotion, RefusesWeightsThatMakeNoMotion) {
  const auto code = [](std::vector<double> weights) {
    const auto motion = BlendedMotion::create(library(), packed(), weights);
    return motion.ok() ? std::string() : motion.error().code;
  };
  EXPECT_EQ(code(equal_weights()), "");
  EXPECT_EQ(code({1}), "parametric-weights");
  EXPECT_EQ(code({}), "parametric-weights");
  auto weights = equal_weights();
  weights[0] += 0.1;
  EXPECT_EQ(code(weights), "parametric-weights");
  weights[0] = std::nan("");
  EXPECT_EQ(code(weights), "parametric-weights");
  // Far beyond the quickest step there is no time left.
  weights = std::vector<double>(library().examples.size(), 0);
  weights[1] = -20;
  weights[7] = 21;
  EXPECT_EQ(code(weights), "parametric-interval");
}

TEST(BlendedMotion, RefusesRatesThatMakeNoClip) {
  const auto motion = BlendedMotion::create(library(), packed(), equal_weights());
  const auto code = [&](double rate) {
    const auto made = motion->make(rate);
    return made.ok() ? std::string() : made.error().code;
  };
  EXPECT_EQ(code(30), "");
  EXPECT_EQ(code(-1), "clip-rate");
  EXPECT_EQ(code(std::nan("")), "clip-rate");
  EXPECT_EQ(code(HUGE_VAL), "clip-rate");
  EXPECT_EQ(code(1e9), "clip-rate");
  EXPECT_EQ(motion->make(0.1)->clip.frame_count(), 2);
}

// Two frames may last for a quarter of an hour each.
TEST(PackedExamples, TakesNoMemoryForTimeWithoutFrames) {
  Library slow = library();
  for (Example& example : slow.examples) {
    example.motion.rate = 1e-3;
    example.keytimes = {0, 3e3, example.motion.duration()};
  }
  ASSERT_TRUE(check(slow));
  const PackedExamples made = pack_examples(slow);
  EXPECT_LE(made.reference.frames, 5000);
  const auto motion = BlendedMotion::create(slow, made, equal_weights());
  ASSERT_TRUE(motion.ok());
  EXPECT_GT(motion->duration(), 1e3);
  EXPECT_EQ(motion->make(1e5).error().code, "clip-too-long");
}

TEST(PackedExamples, SpreadIsTheLargestAngleBetweenExamples) {
  const Spread spread = widest_spread(packed());
  EXPECT_GT(spread.angle, 5 * kRadiansPerDegree);
  EXPECT_LT(spread.angle, 90 * kRadiansPerDegree);
  Library turned = library();
  turned.examples.resize(2);
  turned.examples[1] = turned.examples[0];
  EXPECT_NEAR(widest_spread(pack_examples(turned)).angle, 0, 1e-6);
  // One of them does it with its head turned backwards.
  Clip& clip = turned.examples[1].motion;
  const auto head = static_cast<std::size_t>(clip.skeleton.find("Head"));
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (std::size_t j = head; j < clip.skeleton.names.size(); ++j) {
      if (j != head && clip.skeleton.parents[j] != static_cast<int>(head)) continue;
      Quatf& q = clip.frame_orientations(f)[j];
      q = axis_rotation(Axis::y, 2.9).cast<float>() * q;
    }
  }
  const Spread wide = widest_spread(pack_examples(turned));
  EXPECT_NEAR(wide.angle, 2.9, 1e-3);
  EXPECT_EQ(wide.joint, static_cast<int>(head));
  // The tip of the head carries nothing.
  turned.examples[1].motion = turned.examples[0].motion;
  for (int f = 0; f < clip.frame_count(); ++f) {
    Quatf& tip = clip.frame_orientations(f)[head + 1];
    tip = axis_rotation(Axis::y, 2.9).cast<float>() * tip;
  }
  ASSERT_TRUE(clip.skeleton.end_sites[head + 1]);
  EXPECT_NEAR(widest_spread(pack_examples(turned)).angle, 0, 1e-6);
}

}  // namespace
}  // namespace krok::parametric
