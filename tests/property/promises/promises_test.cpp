// What public headers promise of every motion, each by the header and its words. README.md in this
// folder lists them, with those that other tests hold. If one fails, a header says what is not so.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "blend/blend_clips.h"
#include "blend/correspondence.h"
#include "camera/look_at.h"
#include "compare/clip_difference.h"
#include "filter/smooth_clip.h"
#include "filter/spikes.h"
#include "formats/anim/anim.h"
#include "formats/container/packed_orientation.h"
#include "ik/goal_motion.h"
#include "motion/hips_root.h"
#include "motion/join.h"
#include "motion/loop.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "positions/from_positions.h"
#include "property/promises/motions.h"
#include "retarget/retarget.h"
#include "support/reduced_motion.h"

namespace krok {
namespace {

using test::Dice;
using test::extent;
using test::metres_apart;
using test::people;
using test::same_bits;

constexpr double kFloat = 1e-6;  // of the extent

int carrier_of(const Clip& clip) {
  return carrying_joint(find_roles(clip.skeleton));
}

// motion/sample.h: "Copies every step-th frame".
TEST(Promises, CutOfAllFramesIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    EXPECT_TRUE(same_bits(cut(clip, 0, clip.frame_count() - 1), clip)) << name;
  }
}

// motion/sample.h: "bit-identical to the original's frame if it falls on one"; "At a frame's time
// the result equals Clip::get_pose".
TEST(Promises, ResampledUpAndDownIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    EXPECT_TRUE(same_bits(*resample(clip, clip.rate), clip)) << name;
    for (const int times : {2, 3, 7}) {
      const Clip dense = *resample(clip, times * clip.rate);
      Clip back = cut(dense, 0, dense.frame_count() - 1, times);
      EXPECT_NEAR(back.rate, clip.rate, 1e-9 * clip.rate);
      back.rate = clip.rate;
      EXPECT_TRUE(same_bits(back, clip)) << name << ", " << times << " times as dense";
      const Clip again = *resample(dense, clip.rate);
      EXPECT_LT(metres_apart(again, clip), 1e-5 * size) << name << ", " << times;
    }
    std::vector<Transform> pose(clip.skeleton.names.size()), sampled = pose,
                                                             scratch(3 * pose.size());
    const int frame = clip.frame_count() / 3;
    clip.get_pose(frame, pose);
    sample(clip, frame / clip.rate, sampled, scratch);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      EXPECT_EQ(pose[j].position, sampled[j].position) << name;
      EXPECT_EQ(pose[j].orientation.coeffs(), sampled[j].orientation.coeffs()) << name;
    }
  }
}

// motion/sample.h: "The clip at `rate`, played `speed` times as fast; the rate may be unchanged".
TEST(Promises, RetimedByNothingIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    for (const auto last : {LastFrame::within, LastFrame::kept}) {
      EXPECT_TRUE(same_bits(*retime(clip, clip.rate, 1, last), clip)) << name;
    }
    const Clip slow = *retime(clip, clip.rate, 0.25, LastFrame::kept);
    const Clip back = *retime(slow, clip.rate, 4, LastFrame::kept);
    EXPECT_LT(metres_apart(back, clip), 1e-5 * size) << name;
  }
}

// motion/loop.h: "a motion that repeats already stays as it is"; "The clip played `rounds` times".
TEST(Promises, AMotionThatRepeatsIsItsLoop) {
  Dice dice(7);
  for (int round = 0; round < 40; ++round) {
    const Clip clip = test::random_motion(dice, 40 + dice.below(40), true);
    const auto looped = loop(clip, 0, {.end = LoopEnd::closed, .climb = LoopClimb::keep});
    ASSERT_TRUE(looped.ok());
    // A jump of velocity by finite differences is not nothing where a motion turns fast between
    // frames.
    EXPECT_LT(metres_apart(looped->clip, clip), 1e-3 * extent(clip)) << round;
    EXPECT_TRUE(same_bits(*repeated(looped->clip, looped->displacement, 1), looped->clip));
    // A round of many is one of them.
    const Clip twice = *repeated(looped->clip, looped->displacement, 2);
    const auto again = loop(twice, 0, {.end = LoopEnd::closed, .climb = LoopClimb::keep});
    ASSERT_TRUE(again.ok());
    EXPECT_LT(metres_apart(again->clip, twice), 1e-3 * extent(twice)) << round;
  }
}

// motion/loop.h: "The loop of a loop is the loop".
TEST(Promises, ALoopIsItsOwnLoop) {
  for (const auto& [name, clip] : test::promised_motions()) {
    if (clip.frame_count() < 8) continue;
    const int carrier = carrier_of(clip);
    // Half and a whole of it, as a user cuts them: ends that do not match, and windows that meet.
    for (const int last : {clip.frame_count() / 2, clip.frame_count() - 1}) {
      const auto once = loop(cut(clip, 0, last), carrier, {});
      ASSERT_TRUE(once.ok()) << name;
      const auto twice = loop(once->clip, carrier, {});
      ASSERT_TRUE(twice.ok()) << name;
      EXPECT_EQ(twice->added_frames, 0) << name;
      // 0.1 mm for a person's size.
      EXPECT_LT(metres_apart(twice->clip, once->clip), 1e-4 * std::max(1.0, extent(clip) / 1.75))
          << name << " to frame " << last;
    }
  }
}

// motion/join.h: "0: a hard cut; the first's last frame replaces the second's first".
TEST(Promises, CutAndAppendedIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    const int at = clip.frame_count() / 2;
    const auto joined = join(cut(clip, 0, at), cut(clip, at, clip.frame_count() - 1),
                             carrier_of(clip), {.blend = 0, .match_height = true});
    ASSERT_TRUE(joined.ok()) << name;
    EXPECT_LT(metres_apart(joined->clip, clip), 3e-6 * size) << name;
  }
}

// motion/travel.h, each function; done twice it is done once.
TEST(Promises, PlacedTwiceIsPlacedOnce) {
  Dice dice(1);
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    const int carrier = carrier_of(clip);
    const auto stays = [&](const Transform& move) {
      return move.position.norm() < kFloat * size * 4 &&
             angle_between(move.orientation, Quat::Identity()) < 1e-5;
    };
    Clip moved = clip;
    move_clip(to_origin(moved, carrier), moved);
    EXPECT_TRUE(stays(to_origin(moved, carrier))) << name;
    moved = clip;
    const double heading = dice.between(-3, 3);
    move_clip(facing_at_start(moved, carrier, heading), moved);
    EXPECT_TRUE(stays(facing_at_start(moved, carrier, heading))) << name;
    moved = clip;
    const std::vector<int> joints = {0, clip.joint_count() - 1};
    move_clip(onto_ground(moved, joints), moved);
    EXPECT_TRUE(stays(onto_ground(moved, joints))) << name;
    moved = clip;
    const double angle = dice.between(-3, 3);
    move_clip(turned_about_start(moved, carrier, angle), moved);
    move_clip(turned_about_start(moved, carrier, -angle), moved);
    EXPECT_LT(metres_apart(moved, clip), 4 * kFloat * size) << name;
    moved = clip;
    ASSERT_TRUE(scale_clip(1, moved));
    EXPECT_TRUE(same_bits(moved, clip)) << name;
    ASSERT_TRUE(scale_clip(3, moved) && scale_clip(1 / 3.0, moved));
    EXPECT_LT(metres_apart(moved, clip), kFloat * size) << name;
  }
}

// motion/travel.h: "Heights and rotations are unchanged"; "So are clips of fewer than two frames".
TEST(Promises, InPlaceTwiceIsInPlaceOnce) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    const int carrier = carrier_of(clip);
    for (const Travel travel : {Travel::all, Travel::trend}) {
      const Clip once = in_place(clip, carrier, travel);
      for (std::size_t i = 0; i < clip.positions.size(); ++i) {
        ASSERT_EQ(once.positions[i].y(), clip.positions[i].y()) << name;
        ASSERT_EQ(once.orientations[i].coeffs(), clip.orientations[i].coeffs()) << name;
      }
      EXPECT_LT(metres_apart(in_place(once, carrier, travel), once), kFloat * size) << name;
    }
    const Clip still = cut(clip, 0, 0);
    EXPECT_TRUE(same_bits(in_place(still, carrier, Travel::all), still)) << name;
  }
}

// motion/hips_root.h: "The inverse"; "the joints below bit for bit where they are"; "Where the hips
// are the root neither changes anything".
TEST(Promises, RootedAndRestoredIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const int carrier = carrier_of(clip);
    const HipsRoot root(clip, carrier);
    const Clip rooted = root.rooted(clip);
    EXPECT_TRUE(root.changes() || same_bits(rooted, clip)) << name;
    const Clip back = root.restored(rooted, clip.skeleton);
    for (int f = 0; f < clip.frame_count(); ++f) {
      for (std::size_t j = 0; j < root.below().size(); ++j) {
        if (root.below()[j] == 0 || static_cast<int>(j) == carrier) continue;
        ASSERT_EQ(back.frame_positions(f)[j], clip.frame_positions(f)[j]) << name;
      }
    }
    // Jitter of less than what counts as standing still goes.
    EXPECT_LT(metres_apart(back, clip), 1e-3) << name;
  }
}

// filter/smooth_clip.h: "Preserves bone lengths, timing, frame rate and frame count"; "Joints with
// 0 in `joints` keep"; "returned unchanged". filter/smooth_clip.h: "preserves constants".
TEST(Promises, FiltersKeepWhatTheySayTheyKeep) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    for (const filter::Smoothing& smoothing :
         {filter::Smoothing(filter::Butterworth{clip.rate / 6, 4}),
          filter::Smoothing(filter::SavitzkyGolay{9, 3})}) {
      Clip constant = cut(clip, 0, std::min(clip.frame_count(), 40) - 1);
      for (int f = 1; f < constant.frame_count(); ++f) {
        std::ranges::copy(constant.frame_positions(0), constant.frame_positions(f).begin());
        std::ranges::copy(constant.frame_orientations(0), constant.frame_orientations(f).begin());
      }
      const auto kept = filter::smooth(constant, smoothing, {});
      ASSERT_TRUE(kept.ok()) << name;
      EXPECT_LT(metres_apart(*kept, constant), 4 * kFloat * size) << name;
      const Clip two = cut(clip, 0, 1);
      EXPECT_TRUE(same_bits(*filter::smooth(two, smoothing, {}), two)) << name;
      const std::vector<std::uint8_t> none(clip.skeleton.names.size(), 0);
      EXPECT_LT(metres_apart(*filter::smooth(clip, smoothing, none), clip), 4 * kFloat * size)
          << name;
      const auto smooth = filter::smooth(clip, smoothing, {});
      ASSERT_TRUE(smooth.ok()) << name;
      EXPECT_EQ(smooth->frame_count(), clip.frame_count());
      EXPECT_EQ(smooth->rate, clip.rate);
      const LocalMotion before = local_motion(clip), after = local_motion(*smooth);
      const auto moving = moving_joints(before);
      for (int j = 1; j < clip.joint_count(); ++j) {
        if (moving[static_cast<std::size_t>(j)] != 0) continue;
        for (int f = 0; f < clip.frame_count(); f += 7) {
          ASSERT_NEAR(after.at(j, f).position.norm(), before.at(j, f).position.norm(),
                      4 * kFloat * size)
              << name << ", " << clip.skeleton.names[static_cast<std::size_t>(j)];
        }
      }
    }
  }
}

// filter/smooth_clip.h: "uniform motion is unchanged"; "A uniform or zero rotation is
// unchanged"; "filtering a q(t) b gives a filtered(q(t)) b"; "q and -q are equivalent".
TEST(Promises, SeriesFiltersKeepUniformMotion) {
  Dice dice(2);
  const auto sections = filter::design({6, 4}, 60);
  ASSERT_TRUE(sections.ok());
  const filter::SeriesFilter low_pass = [&](std::span<double> series) {
    filter::filter_both_ways(*sections, 40, series);
  };
  for (int round = 0; round < 50; ++round) {
    const Quat start = dice.rotation(), a = dice.rotation(), b = dice.rotation();
    const Vec3 step = dice.vector(0.3), from = dice.vector(5), way = dice.vector(0.1);
    std::vector<Quat> uniform, noisy, around, flipped;
    std::vector<Vec3> line;
    for (int f = 0; f < 80; ++f) {
      uniform.push_back((start * from_rotation_vector(f * step)).normalized());
      line.emplace_back(from + f * way);
      noisy.push_back((uniform.back() * from_rotation_vector(dice.vector(0.2))).normalized());
      around.push_back((a * noisy.back() * b).normalized());
      flipped.push_back(noisy.back());
      if (dice.below(2) == 0) flipped.back().coeffs() *= -1;
    }
    std::vector<Quat> result = uniform;
    filter::smooth_rotations(low_pass, result);
    std::vector<Vec3> places = line;
    filter::smooth_positions(low_pass, places);
    std::vector<Quat> plain = noisy, turned = around, signs = flipped;
    for (auto* series : {&plain, &turned, &signs}) filter::smooth_rotations(low_pass, *series);
    for (std::size_t f = 0; f < result.size(); ++f) {
      ASSERT_LT(angle_between(result[f], uniform[f]), 1e-9);
      ASSERT_LT((places[f] - line[f]).norm(), 1e-9);
      ASSERT_LT(angle_between((a * plain[f] * b).normalized(), turned[f]), 1e-7);
      ASSERT_LT(angle_between(plain[f], signs[f]), 1e-9);
    }
  }
}

// filter/spikes.h: "Without spikes the clip is returned bit for bit"; "Joints with 0 are
// unchanged".
TEST(Promises, WithoutSpikesNothingChanges) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const auto once = filter::remove_spikes(clip, {}, {});
    ASSERT_TRUE(once.ok()) << name;
    EXPECT_TRUE(!once->spikes.empty() || same_bits(once->clip, clip)) << name;
    const std::vector<std::uint8_t> none(clip.skeleton.names.size(), 0);
    EXPECT_TRUE(same_bits(filter::remove_spikes(clip, {}, none)->clip, clip)) << name;
  }
}

// tracks/reduce_keys.h: "metres, <= tolerance".
TEST(Promises, ReducedAndReducedAgainIsWithinTheTolerance) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    const ReduceOptions options{.tolerance = 1e-3};
    const auto once = test::reduce_keys(clip, options);
    ASSERT_TRUE(once.ok()) << name;
    EXPECT_LE(once->reduction.largest_error, options.tolerance) << name;
    EXPECT_LE(once->reduction.keys_after, once->reduction.keys_before);
    Clip reduced = clip;
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = 0; f < clip.frame_count(); ++f) {
      once->pose_at(f / clip.rate, pose);
      reduced.set_pose(f, pose);
    }
    for (std::size_t i = 0; i < clip.positions.size(); ++i) {
      ASSERT_LT((reduced.positions[i] - clip.positions[i]).norm(),
                options.tolerance + 4 * kFloat * size)
          << name;
    }
    const auto twice = test::reduce_keys(reduced, options);
    ASSERT_TRUE(twice.ok()) << name;
    EXPECT_LE(twice->reduction.largest_error, options.tolerance) << name;
  }
}

// formats/container/packed_orientation.h: "packs to the same three floats".
TEST(Promises, PackedOrientationsPackToThemselves) {
  Dice dice(4);
  for (int i = 0; i < 20000; ++i) {
    Quat q = dice.rotation();
    if (i % 3 == 0) q.w() *= std::pow(10.0, -dice.between(0, 12));
    const auto packed = pack_orientation(q.normalized());
    const Quat back = unpack_orientation(packed);
    ASSERT_EQ(pack_orientation(back), packed);
    ASSERT_EQ(pack_orientation(back.cast<float>().cast<double>()), packed);
    ASSERT_LE(back.w(), 0);
  }
}

// formats/anim/anim.h: "a clip that was read from a file gives the bytes of that file".
TEST(Promises, AFileReadAndWrittenIsTheFile) {
  const std::string folder = (std::filesystem::temp_directory_path() / "krok-promises-XXXXXX");
  std::string path = folder;
  ASSERT_NE(mkdtemp(path.data()), nullptr);
  const auto written = [&](const Clip& clip, OrientationEncoding orientation) {
    auto file = OutputFile::create(path + "/a.anim");
    EXPECT_TRUE(file && anim::write(clip, {.orientation = orientation}, *file) && file->commit());
    const auto input = InputFile::open(path + "/a.anim");
    return std::string(input->text());
  };
  for (const auto& [name, clip] : test::promised_motions()) {
    for (const auto orientation : {OrientationEncoding::xyz, OrientationEncoding::xyzw}) {
      const std::string bytes = written(clip, orientation);
      const auto read = anim::read(std::as_bytes(std::span(bytes)));
      ASSERT_TRUE(read.ok()) << name;
      EXPECT_TRUE(written(*read, orientation) == bytes) << name;
    }
  }
  std::filesystem::remove_all(path);
}

// compare/clip_difference.h: a metric: nothing from itself, the same both ways, no longer than by
// way of another.
TEST(Promises, DifferencesAreAMetric) {
  Dice dice(5);
  for (const auto& [name, motion] : test::promised_motions()) {
    const Clip& clip = motion;  // clang captures no structured bindings
    const auto nudged = [&](double size) {
      Clip other = clip;
      for (Vec3f& position : other.positions) position += dice.vector(size).cast<float>();
      for (Quatf& turn : other.orientations) {
        turn = (turn.cast<double>() * from_rotation_vector(dice.vector(size))).cast<float>();
        turn.normalize();
      }
      return other;
    };
    const Clip second = nudged(0.01), third = nudged(0.02);
    const auto between = [](const Clip& a, const Clip& b) {
      auto found = compare::difference(a, b, {});
      EXPECT_TRUE(found.ok() && found->structure.empty());
      return std::pair(found->positions.largest, found->orientations.largest);
    };
    EXPECT_EQ(between(clip, clip), std::pair(0.0, 0.0)) << name;
    const auto there = between(clip, second), back = between(second, clip);
    EXPECT_NEAR(there.first, back.first, 1e-12) << name;
    EXPECT_NEAR(there.second, back.second, 1e-12) << name;
    const auto far = between(clip, third), on = between(second, third);
    EXPECT_LE(far.first, there.first + on.first + 1e-12) << name;
    EXPECT_LE(far.second, there.second + on.second + 1e-9) << name;
  }
}

// retarget/retarget.h: "A source on its own skeleton is returned bit for bit, whatever its joints
// are called there; on a uniformly scaled copy, scaled".
TEST(Promises, RetargetedOntoItselfIsTheMotion) {
  for (const auto& [name, clip] : people()) {
    const double size = extent(clip);
    Clip target = clip;
    target.resize(0);
    for (std::string& joint : target.skeleton.names) joint = "x" + joint;
    const RoleMap roles = find_roles(clip.skeleton);
    if (!roles.humanoid) continue;
    RoleMap same = roles;
    const auto moved = retarget::transfer(clip, roles, target, same, {});
    ASSERT_TRUE(moved.ok()) << name << ": " << moved.error().message;
    EXPECT_TRUE(same_bits(moved->clip, clip)) << name;
    for (Transform& joint : target.skeleton.reference) joint.position *= 1.25;
    const auto scaled = retarget::transfer(clip, roles, target, same, {});
    ASSERT_TRUE(scaled.ok()) << name;
    Clip expected = clip;
    ASSERT_TRUE(scale_clip(1.25, expected));
    EXPECT_LT(metres_apart(scaled->clip, expected), 1e-5 * size) << name;
  }
}

// ik/goal_motion.h: "Frames in which no goal is active stay bit for bit"; goals that are met change
// nothing.
TEST(Promises, GoalsAtTheirOwnPlacesChangeNothing) {
  for (const auto& [name, clip] : people()) {
    const int hand = find_roles(clip.skeleton).joint(Role::left_hand);
    if (hand < 0 || clip.frame_count() < 30) continue;
    const int frame = clip.frame_count() / 2;
    ik::KeyedGoal goal;
    goal.goal.kind = ik::Goal::Kind::pose;
    goal.goal.joint = hand;
    std::vector<Transform> pose(clip.skeleton.names.size());
    for (int f = frame - 5; f <= frame + 5; ++f) {
      clip.get_pose(f, pose);
      goal.keys.push_back({f / clip.rate,
                           pose[static_cast<std::size_t>(hand)].position,
                           pose[static_cast<std::size_t>(hand)].orientation,
                           {}});
    }
    goal.fade_in = goal.fade_out = 1e-3 / clip.rate;
    const auto done = ik::apply_goals(clip, {&goal, 1}, {}, {});
    ASSERT_TRUE(done.ok()) << name << ": " << done.error().message;
    for (int f = 0; f < clip.frame_count(); ++f) {
      const bool active = std::abs(f - frame) <= 5;
      const double off = metres_apart(cut(done->clip, f, f), cut(clip, f, f));
      if (active) {
        EXPECT_LT(off, 2e-3) << name << ", frame " << f;
      } else {
        EXPECT_TRUE(same_bits(cut(done->clip, f, f), cut(clip, f, f))) << name << ", frame " << f;
      }
    }
  }
}

// blend/blend_clips.h: weighted sums that sum to 1.
TEST(Promises, BlendedWithItselfIsTheMotion) {
  for (const auto& [name, clip] : test::promised_motions()) {
    const double size = extent(clip);
    std::vector<blend::BlendInput> inputs(2);
    inputs[0].clip = inputs[1].clip = &clip;
    inputs[0].name = inputs[1].name = "motion";
    inputs[0].weight = blend::WeightCurve::constant(0.3);
    inputs[1].weight = blend::WeightCurve::constant(0.7);
    for (const auto align : {blend::Align::root, blend::Align::none}) {
      blend::BlendOptions options;
      options.align = align;
      const auto blended =
          blend::blend_clips(inputs, find_roles(clip.skeleton), blend::ends_of(inputs), options);
      ASSERT_TRUE(blended.ok()) << name << ": " << blended.error().message;
      EXPECT_LT(metres_apart(blended->clip, clip), 2e-5 * size) << name;
    }
  }
}

// camera/look_at.h: "motion at constant velocity is unchanged up to both ends"; "Exact for any
// step"; "A time of 0 or less changes nothing".
TEST(Promises, SpringsFollowUniformMotion) {
  Dice dice(6);
  for (int round = 0; round < 100; ++round) {
    const Vec3 from = dice.vector(5), way = dice.vector(0.2);
    const double time = dice.between(0.01, 2), rate = dice.between(10, 200);
    std::vector<Vec3> line;
    for (int f = 0; f < 60; ++f) line.emplace_back(from + f * way);
    std::vector<Vec3> smooth = line;
    smooth_both_ways(smooth, rate, time);
    for (std::size_t f = 0; f < line.size(); ++f) ASSERT_LT((smooth[f] - line[f]).norm(), 1e-9);
    const SpringState start{dice.between(-1, 1), dice.between(-1, 1)};
    const double a = dice.between(-2, 2), b = dice.between(-2, 2), step = dice.between(0.01, 1);
    const SpringState whole = follow(start, a, b, step, time);
    const SpringState half = follow(start, a, 0.5 * (a + b), 0.5 * step, time);
    const SpringState both = follow(half, 0.5 * (a + b), b, 0.5 * step, time);
    EXPECT_NEAR(whole.value, both.value, 1e-9);
    EXPECT_NEAR(whole.velocity, both.velocity, 1e-8);
    std::vector<double> series(20);
    for (double& value : series) value = dice.between(-1, 1);
    const std::vector<double> before = series;
    smooth_both_ways(series, rate, 0);
    EXPECT_EQ(series, before);
  }
}

// positions/from_positions.h: "positions without noise are not changed".
TEST(Promises, PositionsWithoutNoiseStay) {
  for (const auto& [name, clip] : people()) {
    PositionsToPose input;
    input.skeleton = clip.skeleton;
    input.roles = find_roles(clip.skeleton);
    std::vector<Vec3> positions;
    for (const Vec3f& position : clip.positions) positions.push_back(position.cast<double>());
    input.positions = positions;
    input.rate = clip.rate;
    const PoseFromPositions found = from_positions(input);
    EXPECT_FALSE(found.smoothed) << name;
    // The root of rig 2 goes along under hips that bob a little, which counts as a bone.
    EXPECT_LT(found.rms, name == "rig 2" ? 1e-3 : 2e-4) << name;
  }
}

// The body is found whatever the root does, and the root is reported as no joint of it.
TEST(Promises, ARootThatStaysBehindIsNoBone) {
  for (const auto& [name, clip] : people()) {
    if (name != "rig 0") continue;
    const std::size_t joints = clip.skeleton.names.size();
    PositionsToPose input;
    input.skeleton.add("Origin", Skeleton::kNoParent, {});
    for (std::size_t j = 0; j < joints; ++j) {
      input.skeleton.add(clip.skeleton.names[j], clip.skeleton.parents[j] + 1,
                         clip.skeleton.reference[j]);
    }
    input.roles = find_roles(input.skeleton);
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < clip.positions.size(); ++i) {
      if (i % joints == 0) positions.push_back(Vec3::Zero());
      positions.push_back(clip.positions[i].cast<double>());
    }
    input.positions = positions;
    input.rate = clip.rate;
    const PoseFromPositions found = from_positions(input);
    EXPECT_TRUE(found.root_at_body);
    EXPECT_LT(found.rms, 2e-4);
    EXPECT_LT((found.clip.frame_positions(9)[0] - found.clip.frame_positions(9)[1]).norm(), 1e-6F);
  }
}

// The words of a text on one line, without what marks comments.
std::string words_of(const std::string& text) {
  std::istringstream stream(text);
  std::string words, word;
  while (stream >> word) {
    if (word != "//") words += (words.empty() ? "" : " ") + word;
  }
  return words;
}

TEST(Promises, HeadersHaveTheWordsThatAreListed) {
  const auto text_of = [](const std::string& path) {
    const auto file = InputFile::open(test::source_folder() + "/" + path);
    return file.ok() ? std::string(file->text()) : std::string();
  };
  std::istringstream list(text_of("tests/property/promises/README.md"));
  int promises = 0;
  for (std::string line; std::getline(list, line);) {
    if (!line.starts_with("| `")) continue;
    const std::size_t after = line.find("` | "), end = line.find(" | `", after);
    ASSERT_NE(end, std::string::npos) << line;
    const std::string header = line.substr(3, after - 3);
    const std::string words = line.substr(after + 4, end - after - 4);
    EXPECT_NE(words_of(text_of(header)).find(words), std::string::npos) << header << ": " << words;
    ++promises;
  }
  EXPECT_GT(promises, 25);
}

}  // namespace
}  // namespace krok
