// If these fail, krok-lint misses feet that slide, sink or hover, or blames those that do not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/unit/lint/faulty_walks.h"

namespace krok::lint_test {
namespace {

// Would fail if only feet that slide without a rest, or far in one contact, counted: these are
// carried on by 7 cm a second, now faster and now slower.
TEST(LintFaults, FeetCreepFromStanceToStance) {
  const Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    auto all = m.joint_positions(0);
    const std::vector<Vec3> before(all.begin(), all.end());
    for (std::size_t f = 1; f < all.size(); ++f) {
      Vec3 step = before[f] - before[f - 1];
      const double more = 0.06 * (1 + std::sin(0.5 * static_cast<double>(f)));
      step.x() *= 1 + more, step.z() *= 1 + more;
      all[f] = all[f - 1] + step;
    }
  });
  EXPECT_NE(find(faults_of(clip), Rule::foot_slide, kAt), nullptr);
}

TEST(LintFaults, StairsAreNoFaultOfTheGround) {
  WalkOptions options;
  options.steps = 8;
  options.step_length = 0.32;
  options.rise = 0.16;
  const Clip clip = walk_of(options);
  const auto faults = faults_of(clip);
  EXPECT_EQ(find(faults, Rule::ground, 60), nullptr) << listed(clip, faults);
  ASSERT_FALSE(faults.notes.empty());
  EXPECT_NE(faults.notes.front().find("--ground"), std::string::npos) << faults.notes.front();
}

// Would fail if a foot beside a riser counted as sunk by all of the riser's height.
TEST(LintFaults, FeetSinkIntoRisersByTheShortestWay) {
  const Clip clip = usual_walk();
  float side = 0;
  for (const Vec3f& place : clip.positions) {
    if (place.y() < 0.05F) side = std::max(side, place.x());
  }
  for (const double inside : {0.03, 0.12}) {
    lint::MotionOptions options;
    options.ground = [&](const Vec3& point) {
      return std::optional(point.x() > side - inside ? 0.3 : 0.0);
    };
    const auto faults = faults_of(clip, options);
    const bool sinks = std::ranges::any_of(
        faults.findings, [](const lint::Finding& f) { return f.rule == Rule::ground; });
    EXPECT_EQ(sinks, inside > 0.06) << inside << "\n" << listed(clip, faults);
  }
}

// Would fail if heels were held against where balls stand: of who walks on tiptoe for most of the
// time, heels are taken for higher than they are, and sank by 66 mm where they stand.
TEST(LintFaults, HeelsThatStandLowerThanBallsAreNotSunk) {
  const Clip tiptoe = changed(usual_walk(), [](LocalMotion& m, Clip& clip) {
    const Quat down = from_rotation_vector(20 * kRadiansPerDegree * Vec3::UnitX());
    const auto first = [&](auto all) { return all.first(all.size() * 3 / 5); };
    for (const char* side : {"Left", "Right"}) {
      const int foot = clip.skeleton.find(side + std::string("Foot"));
      const int toes = clip.skeleton.find(side + std::string("ToeBase"));
      for (Quat& one : first(m.joint_orientations(foot))) one = one * down;
      for (Quat& one : first(m.joint_orientations(toes))) one = down.conjugate() * one;
      const Vec3 ball = clip.skeleton.reference_local(toes).position;
      for (Vec3& hips : first(m.joint_positions(0))) hips.y() += (ball - down * ball).y() / 2;
    }
  });
  lint::MotionOptions options;
  options.settings.enabled.fill(false);
  options.settings.enabled[static_cast<std::size_t>(Rule::ground)] = true;
  EXPECT_TRUE(faults_of(tiptoe, options).findings.empty())
      << listed(tiptoe, faults_of(tiptoe, options));
}

TEST(LintFaults, TreadmillsSlideNoFeet) {
  Clip clip;
  for (const double sway : {0.074, 0.0}) {  // metres, as keyed walks do
    clip = changed(usual_walk(), [&](LocalMotion& m, Clip&) {
      auto places = m.joint_positions(0);
      for (int f = 0; f < m.frames; ++f) {
        places[at(f)].x() = 0, places[at(f)].z() = sway * std::sin(0.21 * f);
      }
    });
    // One line for all steps, with the ground's speed.
    const auto faults = faults_of(clip);
    EXPECT_EQ(std::ranges::count(faults.findings, Rule::drift, &lint::Finding::rule), 0);
    ASSERT_EQ(std::ranges::count(faults.findings, Rule::foot_slide, &lint::Finding::rule), 1)
        << listed(clip, faults);
    EXPECT_THAT(find(faults, Rule::foot_slide, kAt)->detail, testing::HasSubstr("in place"));
  }
  lint::MotionOptions options;
  options.treadmill = true;
  EXPECT_EQ(find(faults_of(clip, options), Rule::foot_slide, kAt), nullptr);
}

// Would fail if feet of crawlers, which are dragged, counted as standing.
TEST(LintFaults, WhoCrawlsDoesNotSlide) {
  Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    for (Vec3& place : m.joint_positions(0)) place.x() = place.z() = 0;
  });
  EXPECT_NE(find(faults_of(clip), Rule::foot_slide, kAt), nullptr);
  for (int f = 0; f < clip.frame_count(); ++f) clip.frame_positions(f)[0].y() -= 0.6F;
  EXPECT_EQ(find(faults_of(clip), Rule::foot_slide, kAt), nullptr);
}

// Would fail if heels, which are estimated, were in the ground where the toes, which joints mark,
// are on it.
TEST(LintFaults, EstimatedHeelsAloneDoNotSink) {
  Clip clip = usual_walk();
  const int foot = clip.skeleton.find("RightFoot");
  for (int f = 0; f < 20; ++f) clip.frame_positions(kAt + f)[at(foot)].y() -= 0.2F;
  const auto faults = faults_of(clip);
  EXPECT_NE(find(faults, Rule::bone_length, kAt), nullptr) << listed(clip, faults);
  EXPECT_EQ(find(faults, Rule::ground, kAt), nullptr) << listed(clip, faults);
}

// Would fail if feet ahead of who sits, which bear nobody, counted as standing.
TEST(LintFaults, WhoSitsDoesNotSlide) {
  const Clip walk = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    for (Vec3& place : m.joint_positions(0)) place.x() = place.z() = 0;
  });
  for (const float behind : {0.0F, 0.55F}) {
    Clip clip = walk;
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.frame_positions(f)[0] -= Vec3f(0, 0.35F, behind);
    }
    EXPECT_EQ(find(faults_of(clip), Rule::foot_slide, kAt) == nullptr, behind > 0);
  }
}

TEST(LintFaults, FeetThatLandAndLeaveFastSlideNowhere) {
  // A frame of several, so that feet stop and leave within one or two.
  for (const int factor : {6, 7}) {
    const Clip slow = usual_walk(factor == 6 ? 24 : 30);
    Clip fast = slow;
    fast.rate = 25;
    fast.resize(slow.frame_count() / factor);
    for (int f = 0; f < fast.frame_count(); ++f) {
      std::ranges::copy(slow.frame_positions(factor * f), fast.frame_positions(f).begin());
      std::ranges::copy(slow.frame_orientations(factor * f), fast.frame_orientations(f).begin());
    }
    lint::MotionOptions options;
    options.settings.enabled.fill(false);
    options.settings.enabled[static_cast<std::size_t>(Rule::foot_slide)] = true;
    const auto faults = faults_of(fast, options);
    EXPECT_TRUE(faults.findings.empty()) << factor << "\n" << listed(fast, faults);
  }
}

// Would fail if feet of runs, which have landed before they are at rest, slid meanwhile; a foot
// that keeps its speed does.
TEST(LintFaults, FeetThatSlowDownOnTheGroundLand) {
  const double rate = 60;
  const Clip walk = usual_walk(rate);
  for (const bool lands : {true, false}) {
    const Clip clip = changed(walk, [&](LocalMotion& m, Clip& c) {
      for (int j = 1; j < m.joints; ++j)
        std::ranges::fill(m.joint_orientations(j), m.joint_orientations(j)[0]);
      double way = 0;
      const Vec3 start = m.joint_positions(0)[0];
      for (std::size_t f = 0; f < m.joint_positions(0).size(); ++f) {
        const double phase = static_cast<double>(f % 30) / rate;
        const double landing = std::max(0.0, 10.2 * (0.25 - phase)), slide = phase > 0.15 ? 0.7 : 4;
        Quat& leg = m.joint_orientations(c.skeleton.find("LeftUpLeg"))[f];
        if (phase < 0.4) leg = leg * turn(60);
        m.joint_positions(0)[f] = start + Vec3(0, 0, way);
        way += (phase > 0.4 ? 4 : lands ? landing : slide) / rate;
      }
      std::ranges::fill(m.joint_orientations(0), m.joint_orientations(0)[0]);
    });
    const auto faults = faults_of(clip);
    EXPECT_EQ(find(faults, Rule::foot_slide, kAt + 16) == nullptr, lands) << listed(clip, faults);
  }
}

bool slides(const Clip& clip) {
  const auto faults = faults_of(clip);
  return std::ranges::any_of(
      faults.findings, [](const lint::Finding& found) { return found.rule == Rule::foot_slide; });
}

// Would fail if heel and toes, which move where a foot turns about the place between them, slid.
TEST(LintFaults, FeetThatTurnOnTheirSolesDoNotSlide) {
  const auto turns = [](double seconds) {
    return std::pair(Vec3(Vec3::Zero()), 1.2 * std::clamp(2 * (seconds - 2), 0.0, 1.0));
  };
  EXPECT_FALSE(slides(stander(0.05, turns)));
  EXPECT_TRUE(slides(stander(0.5, turns)));
}

// Would fail if a foot that is lifted by 2 cm and put down 8 cm farther on slid there.
TEST(LintFaults, LowStepsAreNoSlides) {
  for (const double lift : {0.0, 0.02}) {
    const Clip clip = stander(0, [&](double seconds) {
      const double part = std::clamp((seconds - 2) / 0.24, 0.0, 1.0);
      const double eased = part * part * (3 - 2 * part);
      return std::pair(Vec3(0.08 * eased, lift * 4 * eased * (1 - eased), 0), 0.0);
    });
    EXPECT_EQ(slides(clip), lift == 0) << lift;
  }
}

// Would fail if feet that rest on what carries a seat, 0.3 m up, showed where the floor is.
TEST(LintFaults, WhoSitsShowsNoFloor) {
  for (const double thigh : {0.0, -80.0}) {
    Clip clip = stander(0, [](double) { return std::pair(Vec3(0, 0.3, 0), 0.0); });
    clip = changed(clip, [&](LocalMotion& m, Clip& c) {
      for (const char* side : {"Left", "Right"}) {
        const std::string name = side;
        for (const auto& [joint, degrees] :
             {std::pair(name + "UpLeg", thigh), std::pair(name + "Leg", -thigh)}) {
          const int j = c.skeleton.find(joint);
          const Vec3 left = c.skeleton.reference[at(j)].orientation.conjugate() * Vec3::UnitX();
          const Quat bent = c.skeleton.reference_local(j).orientation *
                            from_rotation_vector(degrees * kRadiansPerDegree * left);
          std::ranges::fill(m.joint_orientations(j), bent);
        }
      }
    });
    const auto found = faults_of(clip);
    EXPECT_EQ(find(found, Rule::ground, kAt) == nullptr, thigh != 0) << listed(clip, found);
  }
}

// Would fail if a foot that comes down for 0.4 s, slower and slower, slid while its toes are near
// the ground; one that slows down on the ground slides.
TEST(LintFaults, FeetThatStillComeDownLand) {
  for (const double height : {0.0, 0.03}) {
    const Clip clip = stander(0, [&](double seconds) {
      const double left = std::pow(std::clamp((2.4 - seconds) / 0.4, 0.0, 1.0), 2);
      return std::pair(Vec3(-0.12 * left, height * left, 0), 0.0);
    });
    EXPECT_EQ(slides(clip), height == 0) << height << "\n" << listed(clip, faults_of(clip));
  }
}

// Would fail if a foot that leaves its rest and goes 20 cm along the ground in a quarter of a
// second, as in a dance, slid there; a slower one does.
TEST(LintFaults, QuickFeetShuffle) {
  for (const double duration : {0.25, 0.8}) {
    const Clip clip = stander(0, [&](double seconds) {
      const double part = std::clamp((seconds - 2) / duration, 0.0, 1.0);
      return std::pair(Vec3(0.2 * part * part * (3 - 2 * part), 0, 0), 0.0);
    });
    EXPECT_EQ(slides(clip), duration > 0.5) << duration;
  }
}

// Would fail if key poses a second apart were taken for a foot that slides from one to the next.
TEST(LintFaults, PosesASecondApartShowNoSlides) {
  for (const double rate : {1.0, 12.0}) {
    Clip poses = stander(0, [&](double seconds) {
      const double way = 0.2 * std::sin(60 * seconds / rate);
      return std::pair(Vec3(way, 0, 0), 0.0);
    });
    poses.rate = rate;
    EXPECT_EQ(slides(poses), rate > 10) << listed(poses, faults_of(poses));
  }
}

// Would fail if feet that settle by 6 cm within eight seconds, which nobody sees, slid.
TEST(LintFaults, FeetSettleSlowly) {
  for (const double duration : {1.5, 8.0}) {
    const Clip clip = stander(0, [&](double seconds) {
      return std::pair(Vec3(0.06 * std::min(1.0, seconds / duration), 0, 0), 0.0);
    });
    EXPECT_EQ(slides(clip), duration < 2) << duration;
  }
}

// Would fail if tips of toes, which many skeletons do not bend, sank as soon as feet do.
TEST(LintFaults, TipsOfToesSinkDeeper) {
  for (const double depth : {0.09, 0.13}) {
    Clip clip = stander(0, [](double) { return std::pair(Vec3(Vec3::Zero()), 0.0); });
    const int toes = clip.skeleton.find("RightToeBase");
    const auto tip = std::ranges::find(clip.skeleton.parents, toes);
    ASSERT_NE(tip, clip.skeleton.parents.end());
    for (int f = 0; f < 5; ++f) {
      clip.frame_positions(kAt + f)[at(static_cast<int>(tip - clip.skeleton.parents.begin()))]
          .y() -= static_cast<float>(depth);
    }
    EXPECT_EQ(find(faults_of(clip), Rule::ground, kAt) != nullptr, depth > 0.1) << depth;
  }
}

// Would fail if the way of heels and toes, which hang on the ankle where no joint marks them, were
// taken for that of the foot: it tilts by 35 degrees here, as one that a sensor on it shows.
TEST(LintFaults, FeetWithoutToesStandWhereTheirAnklesDo) {
  const Clip walk = stander(0, [](double) { return std::pair(Vec3(Vec3::Zero()), 0.0); });
  Clip clip;
  clip.rate = walk.rate;
  std::vector<int> kept;
  for (int j = 0; j < walk.joint_count(); ++j) {
    if (walk.skeleton.names[at(j)].find("Toe") != std::string::npos) continue;
    const int parent = walk.skeleton.parents[at(j)];
    const auto place = std::ranges::find(kept, parent);
    clip.skeleton.add(walk.skeleton.names[at(j)],
                      parent < 0 ? parent : static_cast<int>(place - kept.begin()),
                      walk.skeleton.reference[at(j)], walk.skeleton.end_sites[at(j)] != 0);
    kept.push_back(j);
  }
  const int foot = clip.skeleton.find("RightFoot");
  for (int f = 0; f < walk.frame_count(); ++f) {
    for (const int j : kept) {
      clip.positions.push_back(walk.frame_positions(f)[at(j)]);
      clip.orientations.push_back(walk.frame_orientations(f)[at(j)]);
    }
    const double part = std::clamp((f - 120) / 120.0, 0.0, 1.0);
    const Vec3 axis = 35 * kRadiansPerDegree * part * Vec3::UnitX();
    Quatf& turned = clip.frame_orientations(f)[at(foot)];
    turned = turned * from_rotation_vector(axis).cast<float>();
  }
  EXPECT_FALSE(slides(clip));
  EXPECT_EQ(find(faults_of(clip), Rule::ground, 240), nullptr) << listed(clip, faults_of(clip));
}

// Would fail if two contacts of a take in the air, as of climbers, were taken for the ground.
TEST(LintFaults, FeetThatSeldomStandShowNoGround) {
  for (const int stands : {20, 200}) {
    const Clip clip = stander(0, [&](double seconds) {
      const double hanging = std::max(0.0, seconds - stands / 60.0);
      const Vec3 swing(std::sin(12 * hanging), 0, std::cos(12 * hanging));
      return std::pair(Vec3(0.3 * swing + Vec3(0, std::min(0.5, 4 * hanging), 0)), 0.0);
    });
    EXPECT_EQ(find(faults_of(clip), Rule::ground, 240) != nullptr, stands == 200)
        << listed(clip, faults_of(clip));
  }
}

}  // namespace
}  // namespace krok::lint_test
