// If these fail, takes of a pair of skeletons are aligned otherwise than the one that was saved, or
// a mistake in a file is passed over or reported at the wrong place.

#include "formats/alignment/alignment_format.h"

#include <gtest/gtest.h>

#include <random>

#include "support/told_mistakes.h"

namespace krok::alignment {
namespace {

Skeleton one_joint(const std::string& name) {
  Skeleton skeleton;
  skeleton.add(name, -1, {});
  return skeleton;
}

Skeleton hips_and_head() {
  Skeleton skeleton = one_joint("Hips");
  skeleton.add("Head", 0, {});
  return skeleton;
}

constexpr const char* kGood = R"({
  "schema": "krok.alignment/1",
  "source": {
    "Head": {"position": [0, 1.7, 0], "orientation": [0, 0.6, 0, 0.8]},
    "Hips": {"position": [0, 1, 0], "orientation": [0, 0, 0, 1]}
  },
  "target": {"pelvis": {"position": [0, 2, 0.5], "orientation": [0, 0, 0, 1]}}
})";

TEST(AlignmentFormat, ReadsWhatTheSpecSays) {
  const auto poses = read(kGood, hips_and_head(), one_joint("pelvis"));
  ASSERT_TRUE(poses.ok()) << poses.error().message;
  ASSERT_EQ(poses->source.size(), 2U);  // in the skeleton's order
  EXPECT_EQ(poses->source[0].position, Vec3(0, 1, 0));
  EXPECT_EQ(poses->source[1].position, Vec3(0, 1.7, 0));
  EXPECT_EQ(poses->source[1].orientation.y(), 0.6);
  EXPECT_EQ(poses->target.at(0).position, Vec3(0, 2, 0.5));
}

TEST(AlignmentFormat, ComesBackBitForBit) {
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  AlignedPoses poses;
  for (auto* pose : {&poses.source, &poses.source, &poses.target}) {
    Transform& joint = pose->emplace_back();
    joint.position = Vec3(number(random), number(random), number(random));
    joint.orientation =
        Quat(number(random), number(random), number(random), number(random)).normalized();
  }
  const Skeleton target = one_joint("\"quoted\"\n");
  const std::string text = write(poses, hips_and_head(), target);
  const auto again = read(text, hips_and_head(), target);
  ASSERT_TRUE(again.ok()) << again.error().message;
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(again->source[j].position, poses.source[j].position);
    EXPECT_EQ(again->source[j].orientation.coeffs(), poses.source[j].orientation.coeffs());
  }
  EXPECT_EQ(again->target[0].orientation.coeffs(), poses.target[0].orientation.coeffs());
}

TEST(AlignmentFormat, MistakesAreToldWithTheirPlace) {
  const test::Mistake mistakes[] = {
      {"krok.alignment/1", "krok.limits/1", "alignment-structure 2:13"},
      {"\"Head\"", "\"Haed\"", "alignment-joint 4:5", "Head"},
      {"\"Head\"", "\"Hips\"", "json-syntax 5:5"},
      {"\"pelvis\": {\"position\": [0, 2, 0.5], \"orientation\": [0, 0, 0, 1]}", "",
       "alignment-joint 7:13", "pelvis"},
      {"[0, 1.7, 0]", "[0, 1.7]", "alignment-value 4:26", "3 numbers"},
      {"[0, 1.7, 0]", "[0, 1e300, 0]", "alignment-value 4:26", "away"},
      {"[0, 0.6, 0, 0.8]", "[0, 0.6, 0, 0.9]", "alignment-value 4:54", "length"},
      {"\"position\": [0, 1, 0], ", "", "alignment-structure 5:13", "position"},
      {"\"target\"", "\"targets\"", "alignment-structure 7:3", "target"}};
  test::expect_told(kGood, mistakes, [&](const std::string& text) {
    return read(text, hips_and_head(), one_joint("pelvis"));
  });
}

TEST(AlignmentFormat, DamagedTextsNeverGiveHalfAPose) {
  std::mt19937 random(3);
  for (int i = 0; i < 3000; ++i) {
    const auto poses = read(test::damaged(kGood, random), hips_and_head(), one_joint("pelvis"));
    if (!poses.ok()) {
      EXPECT_GT(poses.error().where.line, 0);
      continue;
    }
    for (const Transform& joint : poses->source) {
      EXPECT_TRUE(joint.position.allFinite());
      EXPECT_NEAR(joint.orientation.norm(), 1, 1e-6);
    }
  }
}

}  // namespace
}  // namespace krok::alignment
