// If these fail, krok-lint misses a fault that was put into a clean motion, names it wrongly, or
// blames a motion that has none.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "tests/unit/lint/faulty_walks.h"

namespace krok::lint_test {
namespace {

TEST(LintClean, GeneratedWalksHaveNoFault) {
  for (const double rate : {24.0, 30.0, 60.0, 120.0}) {
    const Clip clip = usual_walk(rate);
    const auto faults = faults_of(clip);
    EXPECT_TRUE(faults.findings.empty()) << rate << " fps\n" << listed(clip, faults);
  }
}

TEST(LintClean, SlowFastAndTurningWalksHaveNoFault) {
  for (const double length : {0.45, 0.7, 0.9}) {
    for (const double turn : {0.0, 12.0}) {
      WalkOptions options;
      options.steps = 10;
      options.step_length = length;
      options.turn = turn * kRadiansPerDegree;
      const Clip clip = walk_of(options);
      const auto faults = faults_of(clip);
      EXPECT_TRUE(faults.findings.empty()) << length << " m, " << turn << " degrees\n"
                                           << listed(clip, faults);
    }
  }
}

struct Seeded {
  const char* name;
  Rule rule;
  std::string kind;
  Change change;
};

std::vector<Seeded> seeded_faults() {
  const auto joint = [](const Clip& clip, const char* name) {
    const int found = clip.skeleton.find(name);
    EXPECT_GE(found, 0) << name;
    return found;
  };
  return {
      {"spike", Rule::pop, "spike",
       [=](LocalMotion& m, Clip& clip) {
         auto all = m.joint_orientations(joint(clip, "LeftForeArm"));
         all[kAt] = all[kAt] * turn(15);
       }},
      {"step", Rule::pop, "step",
       [=](LocalMotion& m, Clip& clip) {
         auto all = m.joint_orientations(joint(clip, "RightArm"));
         for (std::size_t f = kAt; f < all.size(); ++f) all[f] = all[f] * turn(12);
       }},
      {"seam", Rule::pop, "seam",
       [](LocalMotion& m, Clip&) {
         for (int j = 1; j < m.joints; ++j) {
           auto all = m.joint_orientations(j);
           for (std::size_t f = kAt; f < all.size(); ++f) all[f] = all[f] * turn(10);
         }
       }},
      {"jump of the hips", Rule::pop, "step",
       [](LocalMotion& m, Clip&) {
         auto all = m.joint_positions(0);
         for (std::size_t f = kAt; f < all.size(); ++f) all[f] += Vec3(0, 0, 0.2);
       }},
      {"flip", Rule::flip, "",
       [=](LocalMotion& m, Clip& clip) {
         auto all = m.joint_orientations(joint(clip, "LeftArm"));
         for (std::size_t f = kAt; f < kAt + 20; ++f) all[f] = all[f] * turn(170);
       }},
      {"frozen", Rule::frozen, "",
       [](LocalMotion& m, Clip&) {
         for (int j = 0; j < m.joints; ++j) {
           for (int f = kAt; f < kAt + 15; ++f) m.set(j, f, m.at(j, kAt));
         }
       }},
      {"jitter", Rule::jitter, "",
       [=](LocalMotion& m, Clip& clip) {
         std::mt19937 random(1);
         std::normal_distribution<double> noise(0, 3 * kRadiansPerDegree);
         auto all = m.joint_orientations(joint(clip, "Spine"));
         for (std::size_t f = kAt; f < kAt + 60; ++f) {
           all[f] = all[f] * from_rotation_vector({noise(random), noise(random), noise(random)});
         }
       }},
      {"slide", Rule::foot_slide, "",
       [](LocalMotion& m, Clip&) {
         auto all = m.joint_positions(0);
         const std::vector<Vec3> before(all.begin(), all.end());
         for (std::size_t f = 1; f < all.size(); ++f) {
           const double factor = f > kAt && f < kAt + 80 ? 1.3 : 1;
           Vec3 step = before[f] - before[f - 1];
           step.x() *= factor, step.z() *= factor;
           all[f] = all[f - 1] + step;
         }
       }},
      {"bone", Rule::bone_length, "",
       [=](LocalMotion& m, Clip& clip) {
         auto all = m.joint_positions(joint(clip, "LeftForeArm"));
         for (std::size_t f = kAt; f < kAt + 30; ++f) all[f] *= 1.1;
       }},
      {"short bone", Rule::bone_length, "",
       [=](LocalMotion& m, Clip& clip) {
         auto all = m.joint_positions(joint(clip, "LeftToeBase"));
         for (std::size_t f = kAt; f < kAt + 30; ++f) all[f] *= 1.03;
       }},
      {"knee", Rule::joint_limit, "",
       [=](LocalMotion& m, Clip& clip) {
         // The shin forwards: about the body's left axis, whatever the joint's own axes are.
         const int knee = joint(clip, "LeftLeg");
         const Vec3 left =
             clip.skeleton.reference[at(knee)].orientation.conjugate() * Vec3::UnitX();
         const Quat bent = clip.skeleton.reference_local(knee).orientation *
                           from_rotation_vector(-60 * kRadiansPerDegree * left);
         auto all = m.joint_orientations(knee);
         for (std::size_t f = kAt; f < kAt + 60; ++f) all[f] = bent;
       }},
      {"doubled frames", Rule::frame_rate, "doubled",
       [](LocalMotion& m, Clip&) {
         for (int j = 0; j < m.joints; ++j) {
           for (int f = 1; f < m.frames; f += 2) m.set(j, f, m.at(j, f - 1));
         }
       }},
      {"half speed", Rule::frame_rate, "slow", [](LocalMotion&, Clip& clip) { clip.rate /= 2; }},
      {"double speed", Rule::frame_rate, "fast", [](LocalMotion&, Clip& clip) { clip.rate *= 2; }},
      {"floor", Rule::ground, "floor",
       [](LocalMotion& m, Clip&) {
         for (Vec3& place : m.joint_positions(0)) place.y() += 0.3;
       }},
  };
}

TEST(LintFaults, EachIsFoundByItsRuleWhereItIs) {
  const Clip clean = usual_walk();
  for (const Seeded& seeded : seeded_faults()) {
    const Clip clip = changed(clean, seeded.change);
    const auto faults = faults_of(clip);
    const lint::Finding* found = find(faults, seeded.rule, kAt);
    ASSERT_NE(found, nullptr) << seeded.name << "; found:\n" << listed(clip, faults);
    if (!seeded.kind.empty()) {
      EXPECT_EQ(found->kind, seeded.kind) << seeded.name;
    }
    EXPECT_GT(found->excess(), 1) << seeded.name;
  }
}

// Would fail if gestures and impacts, which come again, were pops, or one alone were none.
TEST(LintFaults, ImpactsThatComeAgainAreNoPops) {
  const auto with_impacts = [](int every) {
    return changed(usual_walk(), [=](LocalMotion& m, Clip& clip) {
      auto all = m.joint_orientations(clip.skeleton.find("LeftForeArm"));
      for (int f = kAt % every; f < m.frames; f += every) {
        for (int k = -3; k <= 3; ++k) {
          const int here = f + k;
          if (here < 0 || here >= m.frames) continue;
          all[at(here)] = all[at(here)] * turn(20 * std::exp(-k * k));
        }
      }
    });
  };
  const Clip once = with_impacts(1000), often = with_impacts(30);
  EXPECT_NE(find(faults_of(once), Rule::pop, kAt), nullptr);
  EXPECT_EQ(find(faults_of(often), Rule::pop, kAt), nullptr) << listed(often, faults_of(often));
}

// Would fail if toes were left out, or blamed for springing back when they leave the ground.
TEST(LintFaults, ToesJumpToo) {
  const int toes = usual_walk().skeleton.find("LeftToeBase");
  const Clip clip = changed(usual_walk(), [=](LocalMotion& m, Clip&) {
    auto all = m.joint_orientations(toes);
    all[kAt] = all[kAt] * turn(30);
  });
  EXPECT_NE(find(faults_of(clip), Rule::pop, kAt), nullptr) << listed(clip, faults_of(clip));
}

// Would fail if toes that the ground bent, and that are straight again a frame after it, jumped at
// 24 frames a second, or if all steps of toes were such.
TEST(LintFaults, ToesSpringBackWithinAFrame) {
  for (const bool straightens : {true, false}) {
    const Clip clip = changed(usual_walk(24), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find("LeftToeBase"));
      for (int f = 55; f < m.frames; ++f) {
        const double bent = f < 60 ? std::pow(f - 54, 2) * 1.7 : straightens ? 0 : -30;
        all[at(f)] = all[at(f)] * turn(bent);
      }
    });
    EXPECT_EQ(find(faults_of(clip), Rule::pop, 60) == nullptr, straightens)
        << listed(clip, faults_of(clip));
  }
}

// Would fail if fingers that start within a frame of 42 ms jumped, or if they never jumped.
TEST(LintFaults, FingersAreFast) {
  const auto jumps = [](double rate, double degrees) {
    const int frame = static_cast<int>(2.5 * rate);
    const Clip clip = changed(usual_walk(rate), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find("LeftHandMiddle1"));
      for (int f = frame; f < m.frames; ++f) all[at(f)] = all[at(f)] * turn(degrees);
    });
    return find(faults_of(clip), Rule::pop, frame) != nullptr;
  };
  EXPECT_FALSE(jumps(24, 12));
  EXPECT_TRUE(jumps(24, 30));
  EXPECT_TRUE(jumps(60, 12));
}

// Would fail if feet that slap on the ground at each step jumped, as a forearm does that turns so.
TEST(LintFaults, FeetSlapAgainAndAgain) {
  for (const char* name : {"LeftFoot", "LeftForeArm"}) {
    const Clip clip = changed(usual_walk(), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find(name));
      for (int f = 0; f < m.frames; ++f) {
        if (f / 30 % 2 == 1) all[at(f)] = all[at(f)] * turn(25);
      }
    });
    const bool jumps = find(faults_of(clip), Rule::pop, kAt) != nullptr;
    EXPECT_EQ(jumps, std::string(name) == "LeftForeArm") << listed(clip, faults_of(clip));
  }
}

// Would fail if a limb that turns by 120 degrees in a seventh of a second turned over.
TEST(LintFaults, LongFramesAreNoFlips) {
  Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip& c) {
    auto all = m.joint_orientations(c.skeleton.find("LeftForeArm"));
    for (std::size_t f = kAt; f < all.size(); ++f) all[f] = all[f] * turn(120);
  });
  EXPECT_NE(find(faults_of(clip), Rule::flip, kAt), nullptr);
  clip.rate = 7;
  EXPECT_EQ(find(faults_of(clip), Rule::flip, kAt), nullptr);
}

// Would fail if half a second of two were called smooth: so few windows do not show what is usual.
TEST(LintFaults, ShortTakesShowNoUsualDetail) {
  for (const double seconds : {2.0, 5.0}) {
    Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
      for (int j = 0; j < m.joints; ++j) {
        auto all = m.joint_orientations(j);
        for (int f = 30; f < 75; ++f) all[at(f)] = all[30].slerp((f - 30) / 45.0, all[75]);
      }
    });
    clip.resize(std::min(clip.frame_count(), static_cast<int>(seconds * clip.rate)));
    EXPECT_EQ(find(faults_of(clip), Rule::over_smooth, 50) == nullptr, seconds < 3)
        << listed(clip, faults_of(clip));
  }
}

// Would fail if the window in which a pose that is held for long ends looked smooth.
TEST(LintFaults, HeldPosesAreNotSmoothed) {
  const Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    for (int j = 0; j < m.joints; ++j) {
      auto all = m.joint_orientations(j);
      std::fill(all.begin(), all.begin() + 130, all[130]);
    }
  });
  const auto faults = faults_of(clip);
  for (const lint::Finding& found : faults.findings) {
    EXPECT_NE(found.rule, Rule::over_smooth) << listed(clip, faults);
  }
}

// Would fail if what is usual were that of most windows: two thirds of this take are smoothed.
TEST(LintFaults, ATakeThatIsSmoothedForMostOfItsTime) {
  const Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    for (int j = 0; j < m.joints; ++j) {
      auto all = m.joint_orientations(j);
      const std::vector<Quat> before(all.begin(), all.end());
      for (int f = m.frames / 6; f < m.frames * 5 / 6; ++f) {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int k = -8; k <= 8; ++k) {
          const Quat& one = before[at(f + k)];
          sum += (one.dot(before[at(f)]) < 0 ? -1 : 1) * std::exp(-k * k / 18.0) * one.coeffs();
        }
        all[at(f)] = Quat(sum.normalized());
      }
    }
  });
  EXPECT_NE(find(faults_of(clip), Rule::over_smooth, clip.frame_count() / 2), nullptr);
}

// Would fail if what is generated without the captures' noise, out of a rest and into one, were
// called smoothed, as all walks of krok-walk were.
TEST(LintFaults, EasedOutOfARestAndIntoOneIsNotSmoothed) {
  const Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    constexpr int kFrames = 50;
    const auto ease = [&](auto all, const auto& between) {
      const auto first = all[kFrames], last = all[all.size() - 1 - kFrames];
      for (std::size_t f = 0; f < kFrames; ++f) {
        const double part = std::pow(static_cast<double>(f) / kFrames, 2);
        all[f] = between(all[0], first, part);
        all[all.size() - 1 - f] = between(all[all.size() - 1], last, part);
      }
    };
    for (int j = 0; j < m.joints; ++j) {
      ease(m.joint_orientations(j),
           [](const Quat& a, const Quat& b, double part) { return a.slerp(part, b); });
      ease(m.joint_positions(j),
           [](const Vec3& a, const Vec3& b, double part) { return Vec3(a + part * (b - a)); });
    }
  });
  for (const lint::Finding& finding : faults_of(clip).findings) {
    EXPECT_NE(finding.rule, Rule::over_smooth) << listed(clip, faults_of(clip));
  }
}

// Would fail if a jump counted as speed, of which the rest of its window had little detail.
TEST(LintFaults, AJumpMakesItsWindowNotSmooth) {
  const Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip&) {
    for (int j = 0; j < m.joints; ++j) {
      auto all = m.joint_orientations(j);
      for (std::size_t f = 0; f < 3; ++f) all[f] = all[f] * turn(25 * (3 - static_cast<int>(f)));
    }
  });
  const auto faults = faults_of(clip);
  EXPECT_NE(find(faults, Rule::pop, 2), nullptr) << listed(clip, faults);
  EXPECT_EQ(find(faults, Rule::over_smooth, 2), nullptr) << listed(clip, faults);
}

// Would fail if a take of two steps passed at twice its speed, as too few to judge by, or if feet
// swung over the hips, as in cartwheels, counted as steps.
TEST(LintFaults, ARateThatIsOffShowsInTwoSteps) {
  WalkOptions options;
  options.steps = 3;
  Clip clip = walk_of(options);
  const double rate = clip.rate;
  for (const auto& [factor, kind] : {std::pair(2.0, "fast"), {0.5, "slow"}}) {
    clip.rate = factor * rate;
    const auto faults = faults_of(clip);
    const lint::Finding* found = find(faults, Rule::frame_rate, 0);
    ASSERT_NE(found, nullptr) << factor << "\n" << listed(clip, faults);
    EXPECT_EQ(found->kind, kind);
    Clip over = clip;
    for (int f = 0; f < over.frame_count(); ++f) over.frame_positions(f)[0].y() -= 2;
    EXPECT_EQ(find(faults_of(over), Rule::frame_rate, 0), nullptr);
  }
}

// Would fail if runs were judged by their swings, which take less time than those of walks, and
// not by how fast they fall: these jump 1 m in 0.35 s.
// Hops that differ are those of a dance: lower ones look as if time were slower.
TEST(LintFaults, RunsFallAsBodiesDo) {
  constexpr int kFlight = 21, kStand = 12;
  const Clip walk = usual_walk();
  for (const bool dances : {false, true}) {
    Clip clip = walk;
    for (int f = 1; f < clip.frame_count(); ++f) {
      const int hop = f / (kFlight + kStand), part = std::min(kFlight, f % (kFlight + kStand));
      const double height = 0.5 * 9.81 * part * (kFlight - part) / (clip.rate * clip.rate) *
                            (dances ? std::array{0.25, 0.1, 1.0}[at(hop % 3)] : 1);
      const Vec3f moved(0, static_cast<float>(height),
                        static_cast<float>(hop) + static_cast<float>(part) / kFlight);
      std::ranges::copy(clip.frame_orientations(0), clip.frame_orientations(f).begin());
      std::ranges::transform(clip.frame_positions(0), clip.frame_positions(f).begin(),
                             [&](const Vec3f& place) { return Vec3f(place + moved); });
    }
    for (const auto& [factor, kind] : {std::pair(1.0, ""), {2.0, "fast"}, {0.5, "slow"}}) {
      clip.rate = factor * walk.rate;
      const auto faults = faults_of(clip);
      const lint::Finding* found = find(faults, Rule::frame_rate, 0);
      EXPECT_EQ(found == nullptr ? "" : found->kind, dances ? "" : kind) << listed(clip, faults);
    }
  }
}

// Would fail if people's motion on a toy's short legs, which keeps people's time, were called slow.
TEST(LintFaults, RateIsNotJudgedByLegsThatAreNoPersons) {
  WalkOptions options;
  options.steps = 6;
  Clip clip = walk_of(options);
  clip.rate /= 2.2;
  ASSERT_NE(find(faults_of(clip), Rule::frame_rate, 0), nullptr);
  for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
    const double height = clip.skeleton.reference[j].position.y() / options.stature;
    if (height > 0.56) clip.skeleton.reference[j].position.y() += 0.6 * options.stature;
  }
  EXPECT_EQ(find(faults_of(clip), Rule::frame_rate, 0), nullptr);
}

TEST(LintFaults, UnitOfAGiantIsFound) {
  Clip clip = usual_walk();
  for (Transform& joint : clip.skeleton.reference) joint.position *= 10;
  for (Vec3f& place : clip.positions) place *= 10;
  EXPECT_NE(find(faults_of(clip), Rule::unit, 0), nullptr);
}

TEST(LintFaults, LoopsAreJudgedAtTheirSeamAlone) {
  const Clip clip = usual_walk();
  lint::MotionOptions loop;
  loop.is_loop = true;
  EXPECT_EQ(find(faults_of(clip), Rule::loop_seam, 0), nullptr);
  // Cut in the middle of a step: its end does not lead to its beginning.
  Clip part = clip;
  part.resize(140);
  EXPECT_NE(find(faults_of(part, loop), Rule::loop_seam, 0), nullptr);
}

// Would fail if jumps were looked for only where four frames are known on either side.
TEST(LintFaults, FirstAndLastFramesJumpToo) {
  const int last = usual_walk().frame_count() - 1;
  for (const int frame : {0, 1, 2, 3, last - 3, last - 2, last - 1, last}) {
    const Clip turned = changed(usual_walk(), [&](LocalMotion& m, Clip& clip) {
      auto all = m.joint_orientations(clip.skeleton.find("LeftForeArm"));
      all[static_cast<std::size_t>(frame)] = all[static_cast<std::size_t>(frame)] * turn(15);
    });
    EXPECT_NE(find(faults_of(turned), Rule::pop, frame), nullptr) << frame;
    const Clip moved = changed(usual_walk(), [&](LocalMotion& m, Clip&) {
      m.joint_positions(0)[static_cast<std::size_t>(frame)] += Vec3(0.2, 0, 0);
    });
    EXPECT_NE(find(faults_of(moved), Rule::pop, frame), nullptr) << frame;
  }
}

// Would fail if a jump of two frames, which is one frame at half the rate, counted as sinking.
TEST(LintFaults, WhatSinksForTwoFramesPops) {
  for (const int frames : {2, 12}) {
    const Clip clip = changed(usual_walk(), [&](LocalMotion& m, Clip&) {
      for (Vec3& hips : m.joint_positions(0).subspan(kAt, at(frames))) hips.y() -= 0.12;
    });
    const auto faults = faults_of(clip);
    EXPECT_NE(find(faults, Rule::pop, kAt), nullptr) << listed(clip, faults);
    EXPECT_EQ(find(faults, Rule::ground, kAt) != nullptr, frames == 12) << listed(clip, faults);
  }
}

// Would fail if a jerky gesture of a third of a second shook, as a joint with noise for a second
// does.
TEST(LintFaults, JerksAreNoJitter) {
  for (const int frames : {8, 60}) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 2 * kRadiansPerDegree);
    const Clip clip = changed(usual_walk(30), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find("LeftHand"));
      for (int f = 70; f < std::min(m.frames, 70 + frames); ++f) {
        all[at(f)] =
            all[at(f)] * from_rotation_vector(Vec3(noise(random), noise(random), noise(random)));
      }
    });
    const auto faults = faults_of(clip);
    const bool found = std::ranges::any_of(
        faults.findings, [](const lint::Finding& one) { return one.rule == Rule::jitter; });
    EXPECT_EQ(found, frames > 10) << listed(clip, faults);
  }
}

// Would fail if a foot that shakes for 0.2 s as it lands, in most fourth differences of half a
// second at 30 frames a second, jittered.
TEST(LintFaults, ImpactsAreNoJitter) {
  const Clip clip = changed(usual_walk(30), [&](LocalMotion& m, Clip& c) {
    auto all = m.joint_orientations(c.skeleton.find("LeftFoot"));
    for (int f = 0; f < 5; ++f) all[at(75 + f)] = all[at(75 + f)] * turn(f % 2 == 0 ? 10 : -10);
  });
  for (const lint::Finding& finding : faults_of(clip).findings) {
    EXPECT_NE(finding.rule, Rule::jitter) << listed(clip, faults_of(clip));
  }
}

// Would fail if a list of poses, of two frames each, flipped, jumped and shook.
TEST(LintFaults, PosesAreNoMotion) {
  for (const int held : {2, 1}) {
    const Clip clip = changed(usual_walk(), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find("LeftArm"));
      for (int f = 0; f < m.frames; ++f) {
        for (int j = 0; j < m.joints; ++j) m.set(j, f, m.at(j, f / held * held));
        all[at(f)] = all[0] * turn(100 * std::sin(3 * (f / held)));
      }
    });
    const auto faults = faults_of(clip);
    EXPECT_EQ(find(faults, Rule::flip, kAt) == nullptr, held == 2) << listed(clip, faults);
  }
}

// Would fail if poses that are eased into, held and eased out of, as keys hold them, were frozen,
// or the motion beside them smooth; those that are stopped at full speed are frozen.
TEST(LintFaults, KeysHoldPoses) {
  const auto with_hold = [](int ease) {
    return changed(usual_walk(), [&](LocalMotion& m, Clip&) {
      const LocalMotion before = m;
      for (int f = kAt; f < m.frames; ++f) {
        const int hold = kAt + ease, on = hold + 30;
        double from = f - 30 - ease;  // frames of the walk
        if (f < hold) from = kAt + ease / 2.0 * (1 - std::pow((hold - f) / (1.0 * ease), 2));
        if (f >= hold && f < on) from = kAt + ease / 2.0;
        if (f >= on && f < on + ease) {
          from = kAt + ease / 2.0 * (1 + std::pow((f - on) / (1.0 * ease), 2));
        }
        const int frame = static_cast<int>(from);
        for (int j = 0; j < m.joints; ++j) {
          const Transform a = before.at(j, frame), b = before.at(j, frame + 1);
          m.set(j, f,
                {a.position + (from - frame) * (b.position - a.position),
                 a.orientation.slerp(from - frame, b.orientation)});
        }
      }
    });
  };
  const Clip eased = with_hold(16), stopped = with_hold(0);
  for (const lint::Finding& finding : faults_of(eased).findings) {
    EXPECT_TRUE(finding.rule != Rule::frozen && finding.rule != Rule::over_smooth)
        << listed(eased, faults_of(eased));
  }
  EXPECT_NE(find(faults_of(stopped), Rule::frozen, kAt + 15), nullptr);
}

// Would fail if the thighs of a Biped, which hang from the spine and stay with the pelvis, changed
// their length, or if those that stay with neither did not.
TEST(LintFaults, ThighsOfABipedStayWithThePelvis) {
  for (const bool stays : {true, false}) {
    Clip clip = changed(usual_walk(), [&](LocalMotion& m, Clip& c) {
      auto turned = m.joint_orientations(c.skeleton.find("Spine"));
      for (int f = 0; f < m.frames; ++f) turned[at(f)] = turned[at(f)] * turn(20 * std::sin(f));
      auto places = m.joint_positions(c.skeleton.find("LeftUpLeg"));
      for (int f = 0; f < m.frames && !stays; ++f) places[at(f)] *= 1 + 0.1 * std::sin(f);
    });
    for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
      clip.skeleton.parents[at(clip.skeleton.find(name))] = clip.skeleton.find("Spine1");
    }
    EXPECT_EQ(find(faults_of(clip), Rule::bone_length, kAt) == nullptr, stays)
        << listed(clip, faults_of(clip));
  }
}

// Would fail if a forearm that starts to turn from one frame to the next, and goes on, jumped.
TEST(LintFaults, QuickStartsAreNoJumps) {
  for (const double speed : {0.7, 0.0}) {
    const Clip clip = changed(usual_walk(30), [&](LocalMotion& m, Clip& c) {
      auto all = m.joint_orientations(c.skeleton.find("LeftForeArm"));
      double turned = 0, now = 20;
      for (int f = 75; f < m.frames; ++f, now *= speed) {
        turned += now;
        all[at(f)] = all[at(f)] * turn(turned);
      }
    });
    const auto faults = faults_of(clip);
    EXPECT_EQ(find(faults, Rule::pop, 75) == nullptr, speed > 0) << listed(clip, faults);
  }
}

// Would fail if the knee of a foot that is turned out, as in ballet, bent forwards.
TEST(LintFaults, TurnedOutFeetDoNotBendKnees) {
  Clip clip = usual_walk();
  const auto joint = [&](const char* name) { return at(clip.skeleton.find(name)); };
  for (const bool out : {false, true}) {
    for (int f = 0; f < clip.frame_count(); ++f) {
      const auto places = clip.frame_positions(f);
      const Vec3f hip = places[joint("LeftUpLeg")];
      const Vec3f across = (hip - places[joint("RightUpLeg")]).normalized();
      const Vec3f ahead = out ? across : Vec3f(across.cross(Vec3f::UnitY()).normalized());
      places[joint("LeftLeg")] = hip - 0.4F * Vec3f::UnitY() - 0.15F * ahead;
      places[joint("LeftFoot")] = hip - 0.8F * Vec3f::UnitY();
      places[joint("LeftToeBase")] = places[joint("LeftFoot")] + 0.15F * ahead;
    }
    const auto faults = faults_of(clip);
    const bool found = std::ranges::any_of(
        faults.findings, [](const lint::Finding& one) { return one.rule == Rule::joint_limit; });
    EXPECT_EQ(found, !out) << listed(clip, faults);
  }
}

// Would fail if the fastest speed of feet were that of all frames, of a take that ends long after
// its steps: their swings looked slow.
TEST(LintFaults, StandingLongDoesNotSlowSwings) {
  const Clip walk = usual_walk();
  Clip clip = walk;
  clip.resize(6 * walk.frame_count());
  for (int f = 0; f < clip.frame_count(); ++f) {
    const int from = std::min(f, walk.frame_count() - 1);
    std::ranges::copy(walk.frame_positions(from), clip.frame_positions(f).begin());
    std::ranges::copy(walk.frame_orientations(from), clip.frame_orientations(f).begin());
  }
  clip.rate /= 1.6;
  EXPECT_EQ(find(faults_of(clip), Rule::frame_rate, 0), nullptr) << listed(clip, faults_of(clip));
}

// Would fail if steps to and fro, as of fights and dances, were a gait: these go as a walk does and
// every two steps back again.
TEST(LintFaults, StepsToAndFroAreNoGait) {
  constexpr int kTurn = 80;  // frames
  const Clip walk = usual_walk();
  for (const bool returns : {false, true}) {
    Clip clip = walk;
    for (int f = 0; f < clip.frame_count() && returns; ++f) {
      const int part = f % (2 * kTurn), from = 60 + std::min(part, 2 * kTurn - part);
      std::ranges::copy(walk.frame_positions(from), clip.frame_positions(f).begin());
      std::ranges::copy(walk.frame_orientations(from), clip.frame_orientations(f).begin());
    }
    clip.rate *= 2;
    const auto faults = faults_of(clip);
    EXPECT_EQ(find(faults, Rule::frame_rate, 0) == nullptr, returns) << listed(clip, faults);
  }
}

// Would fail if toes that point along the shin, as a dancer's, said which way a knee bends.
TEST(LintFaults, PointedToesDoNotBendKnees) {
  Clip clip = usual_walk();
  const auto joint = [&](const char* name) { return at(clip.skeleton.find(name)); };
  const std::size_t thigh = joint("LeftUpLeg"), knee = joint("LeftLeg"), foot = joint("LeftFoot");
  for (const float back : {0.2F, 2.0F}) {
    for (int f = 0; f < clip.frame_count(); ++f) {
      const auto places = clip.frame_positions(f);
      const Vec3f shin = (places[foot] - places[knee]).normalized();
      const Vec3f bend = shin - (places[knee] - places[thigh]).normalized();
      places[joint("LeftToeBase")] = places[foot] + 0.15F * (shin + back * bend.normalized());
    }
    const auto faults = faults_of(clip);
    const bool found = std::ranges::any_of(
        faults.findings, [](const lint::Finding& one) { return one.rule == Rule::joint_limit; });
    EXPECT_EQ(found, back > 1) << listed(clip, faults);
  }
}

// Would fail if shoulder blades that glide on the ribs were bones that grow, as a forearm is.
TEST(LintFaults, ShoulderBladesGlide) {
  for (const char* name : {"LeftShoulder", "LeftForeArm"}) {
    const Clip clip = changed(usual_walk(), [&](LocalMotion& m, Clip& c) {
      auto places = m.joint_positions(c.skeleton.find(name));
      for (int f = 0; f < m.frames; ++f) places[at(f)] *= 1 + 0.06 * std::sin(0.05 * f);
    });
    const auto faults = faults_of(clip);
    const bool found = std::ranges::any_of(
        faults.findings, [](const lint::Finding& one) { return one.rule == Rule::bone_length; });
    EXPECT_EQ(found, std::string(name) == "LeftForeArm") << listed(clip, faults);
  }
}

// Would fail if who turns over in the air, with the hips at one height, hung there.
TEST(LintFaults, BodiesFallThoughTheirHipsDoNot) {
  const Clip standing = stander(0, [](double) { return std::pair(Vec3(Vec3::Zero()), 0.0); });
  for (const bool falls : {false, true}) {
    Clip clip = standing;
    for (int f = 0; f < 30; ++f) {
      const double seconds = f / clip.rate;
      const auto fall = static_cast<float>(falls ? 4.9 * seconds * (0.5 - seconds) : 0);
      for (Vec3f& place : clip.frame_positions(kAt + f)) place.y() += 0.3F + fall;
      clip.frame_positions(kAt + f)[0].y() -= fall;
    }
    EXPECT_EQ(find(faults_of(clip), Rule::ground, kAt + 10) == nullptr, falls);
  }
}

// Would fail if the way from a rest frame to the motion were also a joint that turns over.
TEST(LintFaults, RestFramesAreNoFlips) {
  Clip clip = usual_walk();
  const Quatf round = from_rotation_vector(Vec3(0, 2, 0)).cast<float>();
  for (int j = 0; j < clip.joint_count(); ++j) {
    const Transform& rest = clip.skeleton.reference[at(j)];
    clip.frame_positions(0)[at(j)] = round * rest.position.cast<float>();
    clip.frame_orientations(0)[at(j)] = round * rest.orientation.cast<float>();
  }
  const auto faults = faults_of(clip);
  EXPECT_NE(find(faults, Rule::rest_frame, 0), nullptr) << listed(clip, faults);
  EXPECT_EQ(find(faults, Rule::flip, 0), nullptr) << listed(clip, faults);
}

TEST(LintRules, RunOnlyIfEnabledAndByTheirLimits) {
  const Clip clip = changed(usual_walk(), seeded_faults().front().change);
  lint::MotionOptions options;
  options.settings.enabled.fill(false);
  EXPECT_TRUE(faults_of(clip, options).findings.empty());
  options.settings.enabled[static_cast<std::size_t>(Rule::pop)] = true;
  EXPECT_NE(find(faults_of(clip, options), Rule::pop, kAt), nullptr);
  options.settings.thresholds[static_cast<std::size_t>(Rule::pop)] = 30;
  EXPECT_EQ(find(faults_of(clip, options), Rule::pop, kAt), nullptr);
}

TEST(LintRules, ShortMotionsAndLoneJointsAreNoTrouble) {
  Clip clip = usual_walk();
  for (const int frames : {0, 1, 2, 3, 4, 7}) {
    Clip part = clip;
    part.resize(frames);
    EXPECT_EQ(find(faults_of(part), Rule::pop, 0), nullptr) << frames;
  }
  Clip lone;
  lone.skeleton.add("joint", -1, Transform());
  lone.resize(100);
  for (auto& orientation : lone.orientations) orientation.setIdentity();
  for (auto& position : lone.positions) position.setZero();
  EXPECT_TRUE(faults_of(lone).findings.empty());
}

// An animal whose trunk moves against a root on the ground. Would fail if that way were a bone that
// changes its length: a third of public clips of animals had that fault.
TEST(LintRules, TheWayOfABodyAgainstItsRootIsNoBone) {
  Clip animal;
  const auto add = [&](const char* name, int parent, const Vec3& place) {
    return animal.skeleton.add(name, parent, {place, Quat::Identity()});
  };
  add("ground", -1, Vec3::Zero());
  const int trunk = add("barrel", 0, Vec3(0, 1, 0));
  add("snout", trunk, Vec3(0, 1.2, 0.6));
  add("brush", trunk, Vec3(0, 1, -0.7));
  animal.rate = 30;
  animal.resize(60);
  for (int f = 0; f < 60; ++f) {
    const Vec3 up(0, 0.2 * std::sin(0.3 * f), 0);
    for (std::size_t j = 0; j < 4; ++j) {
      const Vec3 place = animal.skeleton.reference[j].position + (j == 0 ? Vec3::Zero() : up);
      animal.frame_positions(f)[j] = place.cast<float>();
      animal.frame_orientations(f)[j].setIdentity();
    }
  }
  EXPECT_EQ(find(faults_of(animal), Rule::bone_length, 30), nullptr);
  // Nor is a neck that an animator stretches.
  Clip stretched = animal;
  for (int f = 0; f < 60; ++f) stretched.frame_positions(f)[2].y() += 0.1F * std::sin(0.2F * f);
  EXPECT_EQ(find(faults_of(stretched), Rule::bone_length, 30), nullptr);
  for (int f = 20; f < 60; ++f) animal.frame_positions(f)[2] += Vec3f(0, 0.1F, 0);
  EXPECT_NE(find(faults_of(animal), Rule::bone_length, 30), nullptr);
}

TEST(LintDuplicates, AreFoundUnderAnotherRatePlaceAndSize) {
  const auto signature = [](const Clip& clip) {
    return lint::signature_of(frames_of(clip), find_roles(clip.skeleton));
  };
  WalkOptions slower;
  slower.steps = 10;
  slower.step_length = 0.6;
  slower.cadence = 110;
  const Clip clip = usual_walk(60);
  const Clip moved = changed(clip, [](LocalMotion& m, Clip&) {
    const Quat turned = from_rotation_vector(Vec3(0, 1, 0));
    for (Vec3& place : m.joint_positions(0)) place = turned * place + Vec3(3, 0, 1);
    for (Quat& one : m.joint_orientations(0)) one = turned * one;
  });
  Clip resampled = clip;
  resampled.rate = 30;
  resampled.resize((clip.frame_count() + 1) / 2);
  for (int f = 0; f < resampled.frame_count(); ++f) {
    std::ranges::copy(clip.frame_positions(2 * f), resampled.frame_positions(f).begin());
    std::ranges::copy(clip.frame_orientations(2 * f), resampled.frame_orientations(f).begin());
  }
  const std::vector<lint::Signature> all = {signature(clip), signature(walk_of(slower)),
                                            signature(resampled), signature(moved)};
  const auto pairs = lint::find_duplicates(all, 4 * kRadiansPerDegree);
  EXPECT_EQ(pairs, (std::vector<std::pair<int, int>>{{0, 2}, {0, 3}}));
}

}  // namespace
}  // namespace krok::lint_test
