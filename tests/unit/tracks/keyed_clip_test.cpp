// Would fail if keys at times of their own did not show what they say, before, at, between and
// after them, or if broken keys passed for sound ones.

#include "tracks/keyed_clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/quaternion.h"
#include "motion/sample.h"
#include "support/test_scenes.h"
#include "tracks/sample_keys.h"

namespace krok {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

VectorTrack vectors() {
  return {VectorCurve::linear, {0.5, 1, 3}, {{0, 1, 0}, {2, 1, -1}, {4, 0, 0}}, {}};
}

RotationTrack rotations() {
  return {RotationCurve::slerp,
          {0, 0.25, 2},
          {Quat::Identity(), from_rotation_vector(Vec3(0, 1.2, 0)),
           from_rotation_vector(Vec3(0.8, 0, 0.7))},
          {}};
}

// Two joints, an arm of one metre along x.
KeyedClip arm() {
  KeyedClip clip;
  clip.skeleton.add("root", -1, {});
  clip.skeleton.add("hand", 0, {Vec3::UnitX(), Quat::Identity()});
  clip.duration = 3;
  clip.joints.resize(2);
  clip.joints[0] = {vectors(), rotations(), {}};
  return clip;
}

std::vector<Transform> pose_at(const KeyedClip& clip, double time, Wrap wrap = Wrap::clamp) {
  std::vector<Transform> pose(clip.joints.size());
  sample_keys(clip, time, wrap, pose, {}, {});
  return pose;
}

TEST(SampleTrack, HoldsItsEndsAndGivesKeysExactly) {
  VectorTrack track = vectors();
  for (const VectorCurve curve :
       {VectorCurve::step, VectorCurve::linear, VectorCurve::hermite, VectorCurve::monotone}) {
    set_curve(track, curve);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(sample_track(track, track.times[k]), track.values[k]);
    EXPECT_EQ(sample_track(track, -1), track.values[0]);
    EXPECT_EQ(sample_track(track, kNan), track.values[0]);
    EXPECT_EQ(sample_track(track, 9), track.values[2]);
  }
  RotationTrack turns = rotations();
  for (const RotationCurve curve :
       {RotationCurve::step, RotationCurve::slerp, RotationCurve::nlerp, RotationCurve::squad}) {
    set_curve(turns, curve);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(sample_track(turns, turns.times[k]).coeffs(), turns.values[k].coeffs());
    }
    EXPECT_EQ(sample_track(turns, 5).coeffs(), turns.values[2].coeffs());
  }
}

TEST(SampleTrack, GoesBetweenKeysAsTheCurveSays) {
  VectorTrack track = vectors();
  EXPECT_LT((sample_track(track, 1.5) - Vec3(2.5, 0.75, -0.75)).norm(), 1e-15);
  set_curve(track, VectorCurve::step);
  EXPECT_EQ(sample_track(track, 2.99), track.values[1]);
  set_curve(track, VectorCurve::hermite, 0.25);
  std::vector<Vec3> velocities(3);
  tension_velocities(track.times, track.values, 0.25, Ends::open, velocities);
  EXPECT_EQ(sample_track(track, 1.5),
            hermite(track.values[1], velocities[1], track.values[2], velocities[2], 2, 0.25));
  set_curve(track, VectorCurve::monotone);
  monotone_velocities(track.times, track.values, Ends::open, velocities);
  EXPECT_EQ(sample_track(track, 1.5), sample_curve(track.times, track.values, velocities, 1.5));

  RotationTrack turns = rotations();
  const double part = (1 - 0.25) / 1.75;
  EXPECT_LT(angle_between(sample_track(turns, 1), slerp(turns.values[1], turns.values[2], part)),
            1e-15);
  set_curve(turns, RotationCurve::nlerp);
  EXPECT_LT(angle_between(sample_track(turns, 1), nlerp(turns.values[1], turns.values[2], part)),
            1e-15);
  set_curve(turns, RotationCurve::step);
  EXPECT_EQ(sample_track(turns, 1).coeffs(), turns.values[1].coeffs());
  set_curve(turns, RotationCurve::squad, 0.1);
  EXPECT_LT(angle_between(sample_track(turns, 1),
                          squad(turns.values[1], turns.velocities[1], turns.values[2],
                                turns.velocities[2], 1.75, part)),
            1e-15);
}

TEST(SampleKeys, WithoutKeysIsTheReferencePose) {
  const auto pose = pose_at(arm(), 1);
  EXPECT_EQ(pose[1].position, Vec3::UnitX());
  EXPECT_EQ(pose[0].position, Vec3(2, 1, -1));
}

TEST(SampleKeys, LoopsAndGoesThereAndBack) {
  const KeyedClip clip = arm();
  EXPECT_LT((pose_at(clip, 4.5, Wrap::loop)[0].position - Vec3(2.5, 0.75, -0.75)).norm(), 1e-14);
  EXPECT_LT((pose_at(clip, -1.5, Wrap::loop)[0].position - Vec3(2.5, 0.75, -0.75)).norm(), 1e-14);
  EXPECT_LT((pose_at(clip, 4.5, Wrap::ping_pong)[0].position - Vec3(2.5, 0.75, -0.75)).norm(),
            1e-14);
  EXPECT_EQ(pose_at(clip, kNan)[0].position, clip.joints[0].position.values[0]);
}

TEST(SampleKeys, CursorsNeverChangeTheResult) {
  const KeyedClip clip = keyed_clip(test::swinging_clip(test::human_skeleton(), 50, 30));
  std::vector<KeyCursor> cursors(clip.joints.size());
  std::vector<Transform> with(clip.joints.size());
  std::vector<double> times;
  for (int i = 0; i < 200; ++i)
    times.push_back(std::fmod(i * (i % 7 == 0 ? 0.77 : 0.0131), 1.7) - 0.02);
  for (const double time : times) {
    sample_keys(clip, time, Wrap::loop, with, {}, cursors);
    const auto without = pose_at(clip, time, Wrap::loop);
    for (std::size_t j = 0; j < with.size(); ++j) {
      EXPECT_EQ(with[j].position, without[j].position);
      EXPECT_EQ(with[j].orientation.coeffs(), without[j].orientation.coeffs());
    }
  }
  std::vector<Transform> many(times.size() * with.size());
  sample_keys(clip, times, Wrap::loop, many, cursors);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(many[i * with.size() + 3].orientation.coeffs(),
              pose_at(clip, times[i], Wrap::loop)[3].orientation.coeffs());
  }
}

TEST(KeyedClip, OfAClipIsTheClipAtEveryTime) {
  const Clip clip =
      test::swinging_clip(test::with_turned_joints(test::human_skeleton()), 40, 59.94);
  const KeyedClip keyed = keyed_clip(clip);
  ASSERT_TRUE(check(keyed).ok()) << check(keyed).error().message;
  std::vector<Transform> world(clip.skeleton.names.size()), scratch(3 * world.size());
  for (double time = 0; time <= clip.duration(); time += 0.0037) {
    sample(clip, time, world, scratch);
    auto pose = pose_at(keyed, time);
    local_to_world(clip.skeleton.parents, pose, pose);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      EXPECT_LT((pose[j].position - world[j].position).norm(), 1e-9);
      EXPECT_LT(angle_between(pose[j].orientation, world[j].orientation), 1e-9);
    }
  }
}

TEST(UniformClip, OfAKeyedClipIsTheClipAgain) {
  const Clip clip = test::swinging_clip(test::human_skeleton(), 40, 30000 / 1001.0);
  const auto again = uniform_clip(keyed_clip(clip), clip.rate);
  ASSERT_TRUE(again.ok());
  ASSERT_EQ(again->frame_count(), clip.frame_count());
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    EXPECT_LT((again->positions[i] - clip.positions[i]).norm(), 1e-6f);
    EXPECT_LT(
        angle_between(again->orientations[i].cast<double>(), clip.orientations[i].cast<double>()),
        1e-6);
  }
  EXPECT_EQ(again->skeleton.names, clip.skeleton.names);
}

TEST(UniformClip, ScalesMoveWhatIsBelow) {
  // The root stretches threefold along its x while it turns to y: the hand goes out along world y.
  KeyedClip clip = arm();
  clip.joints[0] = {{VectorCurve::linear, {0}, {Vec3::Zero()}, {}},
                    {RotationCurve::slerp, {0}, {from_rotation_vector(Vec3(0, 0, kPi / 2))}, {}},
                    {VectorCurve::linear, {0, 1}, {Vec3::Ones(), Vec3(3, 1, 1)}, {}}};
  const auto result = uniform_clip(clip, 2);
  ASSERT_TRUE(result.ok());
  ASSERT_EQ(result->frame_count(), 7);
  for (const auto& [frame, reach] : {std::pair{0, 1.0f}, {1, 2.0f}, {2, 3.0f}, {6, 3.0f}}) {
    EXPECT_LT((result->frame_positions(frame)[1] - Vec3f(0, reach, 0)).norm(), 1e-6f) << frame;
    EXPECT_LT(angle_between(result->frame_orientations(frame)[1].cast<double>(),
                            from_rotation_vector(Vec3(0, 0, kPi / 2))),
              1e-6);
  }
}

TEST(UniformClip, RefusesRatesAndLengthsThatMakeNoClip) {
  for (const double rate : {0.0, -1.0, kNan, 1e9}) {
    const auto result = uniform_clip(arm(), rate);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "clip-rate");
  }
  KeyedClip empty = arm();
  empty.joints[0] = {};
  ASSERT_TRUE(uniform_clip(empty, 30).ok());
  EXPECT_EQ(uniform_clip(empty, 30)->frame_count(), 0);
  EXPECT_TRUE(uniform_clip(KeyedClip(), 30).ok());
}

TEST(KeyedClip, OfNoFramesHasNoKeys) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  const KeyedClip keyed = keyed_clip(clip);
  EXPECT_EQ(keyed.key_count(), 0u);
  EXPECT_TRUE(check(keyed).ok());
}

TEST(KeyedClip, CheckSeesWhatIsBroken) {
  EXPECT_TRUE(check(arm()).ok());
  const auto broken = [](const auto& breaking) {
    KeyedClip clip = arm();
    breaking(clip.joints[0], clip);
    const Status status = check(clip);
    return status.ok() ? std::string("fine") : status.error().code;
  };
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.times.pop_back(); }), "keyed-shape");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.velocities.resize(1); }), "keyed-shape");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.curve = VectorCurve::hermite; }),
            "keyed-shape");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.rotation.curve = RotationCurve::squad; }),
            "keyed-shape");
  EXPECT_EQ(broken([](auto&, auto& clip) { clip.joints.pop_back(); }), "keyed-shape");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.times[1] = 0.5; }), "keyed-time");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.times[2] = 3.5; }), "keyed-time");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.rotation.times[0] = -0.1; }), "keyed-time");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.rotation.times[1] = kNan; }), "keyed-time");
  EXPECT_EQ(broken([](auto&, auto& clip) { clip.duration = kNan; }), "keyed-time");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.position.values[1].y() = kNan; }), "keyed-value");
  EXPECT_EQ(broken([](auto& joint, auto&) { joint.rotation.values[2] = Quat(0, 0, 0, 0); }),
            "keyed-value");
  EXPECT_EQ(broken([](auto& joint, auto&) {
              set_curve(joint.rotation, RotationCurve::squad);
              joint.rotation.velocities[1].x() = kNan;
            }),
            "keyed-value");
  EXPECT_EQ(broken([](auto&, auto& clip) { clip.skeleton.parents[1] = 5; }), "skeleton-parent");
}

}  // namespace
}  // namespace krok
