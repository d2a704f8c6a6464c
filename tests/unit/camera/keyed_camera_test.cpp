// If these fail, a camera through keys passes them elsewhere, at another time or with a jerk, or
// its lens goes beyond what was asked for.

#include "camera/keyed_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "camera/look_at.h"
#include "math/quaternion.h"
#include "scene/camera_track.h"

namespace krok {
namespace {

CameraKey key_at(double time, const Vec3& position, const Vec3& target = Vec3(0, 1, 0)) {
  CameraKey key;
  key.time = time;
  key.position = position;
  key.target = target;
  return key;
}

CameraTrack track_of(const KeyedCamera& camera, double rate = 100) {
  auto track = make_track(camera, rate);
  EXPECT_TRUE(track.ok()) << (track ? "" : track.error().message);
  return track ? *track : CameraTrack();
}

Vec3 place(const CameraTrack& track, double time) {
  return track.positions[static_cast<std::size_t>(std::lround(time * track.rate))].cast<double>();
}
Quat turn(const CameraTrack& track, double time) {
  return track.orientations[static_cast<std::size_t>(std::lround(time * track.rate))]
      .cast<double>();
}
double lens(const CameraTrack& track, double time) {
  return static_cast<double>(
      track.fields_of_view[static_cast<std::size_t>(std::lround(time * track.rate))]);
}

const Vec3 kA(0, 1, 4), kB(2, 2, 4), kC(3, 1, -2), kD(0, 1.5, -4);

KeyedCamera uneven() {
  return {{key_at(0, kA), key_at(0.5, kB), key_at(2, kC), key_at(3, kD)}};
}

TEST(KeyedCamera, IsTheHermiteCurveOfItsUnevenTimes) {
  const CameraTrack track = track_of(uneven());
  ASSERT_EQ(track.frame_count(), 301);
  // Velocities (p_{i+1} - p_{i-1}) / (t_{i+1} - t_{i-1}) and the cubic's basis, by hand at the
  // middle of the second span: (a + b) / 2 + span / 8 (va - vb).
  const Vec3 vb = (kC - kA) / 2, vc = (kD - kB) / 2.5;
  EXPECT_LT((place(track, 1.25) - ((kB + kC) / 2 + 1.5 / 8 * (vb - vc))).norm(), 1e-6);
  // At the open beginning the velocity is that of the one difference.
  const Vec3 va = (kB - kA) / 0.5;
  EXPECT_LT((place(track, 0.25) - ((kA + kB) / 2 + 0.5 / 8 * (va - vb))).norm(), 1e-6);
  for (const auto& [time, at] : {std::pair(0.0, kA), {0.5, kB}, {2.0, kC}, {3.0, kD}}) {
    EXPECT_LT((place(track, time) - at).norm(), 1e-6);
  }
}

TEST(KeyedCamera, VelocityHasNoJump) {
  const CameraTrack track = track_of(uneven(), 2000);
  for (std::size_t i = 1; i + 1 < track.positions.size(); ++i) {
    const Vec3 bend =
        (track.positions[i + 1] - 2 * track.positions[i] + track.positions[i - 1]).cast<double>();
    // Acceleration times a frame's time; a jump of a velocity would be metres a second.
    EXPECT_LT(bend.norm() * track.rate, 0.05) << i;
  }
}

TEST(KeyedCamera, TensionStopsAtAKey) {
  KeyedCamera camera = uneven();
  camera.keys[1].tension = 1;
  const CameraTrack track = track_of(camera, 1000);
  const double speed = (place(track, 0.501) - place(track, 0.499)).norm() / 0.002;
  EXPECT_LT(speed, 0.02);
  const CameraTrack free = track_of(uneven(), 1000);
  EXPECT_GT((place(free, 0.501) - place(free, 0.499)).norm() / 0.002, 1);
}

TEST(KeyedCamera, LinearEaseAndStepAreWhatTheySay) {
  KeyedCamera camera = uneven();
  camera.keys[0].between = Between::linear;
  camera.keys[1].between = Between::ease;
  camera.keys[2].between = Between::step;
  const CameraTrack track = track_of(camera);
  EXPECT_LT((place(track, 0.1) - (kA + 0.2 * (kB - kA))).norm(), 1e-6);
  // A third of the time of ease: 3/9 - 2/27 = 7/27 of the way.
  EXPECT_LT((place(track, 1.0) - (kB + 7.0 / 27 * (kC - kB))).norm(), 1e-6);
  EXPECT_LT((place(track, 2.99) - kC).norm(), 1e-6);
  EXPECT_LT((place(track, 3.0) - kD).norm(), 1e-6);
}

TEST(KeyedCamera, ASmoothCurveEndsWhereAnotherJoinBegins) {
  KeyedCamera camera = uneven();
  camera.keys[2].between = Between::step;
  const CameraTrack track = track_of(camera, 1000);
  // Its last velocity is that of its own last difference, whatever comes after.
  const Vec3 arriving = (place(track, 2.0) - place(track, 1.998)) / 0.002;
  EXPECT_LT((arriving - (kC - kB) / 1.5).norm(), 0.05);
}

TEST(KeyedCamera, AClosedOneGoesOnThroughItsEnd) {
  KeyedCamera camera{{key_at(0, kA), key_at(1, kB), key_at(2.5, kC), key_at(4, kA)}, true};
  const CameraTrack track = track_of(camera, 1000);
  const Vec3 leaving = (place(track, 0.002) - place(track, 0)) / 0.002;
  const Vec3 arriving = (place(track, 4.0) - place(track, 3.998)) / 0.002;
  EXPECT_LT((leaving - arriving).norm(), 0.05);
  EXPECT_LT((leaving - (kB - kC) / 2.5).norm(), 0.05);
}

TEST(KeyedCamera, LooksAtTheMovingTarget) {
  KeyedCamera camera{{key_at(0, {0, 1, 4}, {0, 1, 0}), key_at(1, {0, 1, 4}, {2, 1, 0})}};
  for (CameraKey& key : camera.keys) key.between = Between::linear;
  const CameraTrack track = track_of(camera);
  for (const double t : {0.0, 0.25, 1.0}) {
    const Vec3 looks = turn(track, t) * -Vec3::UnitZ();
    EXPECT_LT((looks - Vec3(2 * t, 0, -4).normalized()).norm(), 1e-6);
    EXPECT_NEAR((turn(track, t) * Vec3::UnitX()).y(), 0, 1e-6);
  }
}

TEST(KeyedCamera, OrientationsAboutOneAxisFollowTheCubicOfTheAngle) {
  KeyedCamera camera;
  const double times[] = {0, 1, 1.5}, angles[] = {0, 1, 0.2};
  for (int i = 0; i < 3; ++i) {
    CameraKey key = key_at(times[i], Vec3::Zero());
    key.target.reset();
    key.orientation = Quat(Eigen::AngleAxisd(angles[i], Vec3::UnitY()));
    if (i == 1) key.orientation->coeffs() *= -1;  // the same rotation
    camera.keys.push_back(key);
  }
  const CameraTrack track = track_of(camera);
  const double v0 = 1, v1 = (0.2 - 0) / 1.5;
  EXPECT_NEAR(angle_between(turn(track, 0.5), Quat::Identity()), 0.5 + (v0 - v1) / 8, 1e-6);
  camera.keys[0].between = Between::linear;
  EXPECT_NEAR(angle_between(turn(track_of(camera), 0.25), Quat::Identity()), 0.25, 1e-6);
}

TEST(KeyedCamera, TargetsAmongOrientationsLookAsTheyStand) {
  KeyedCamera camera = uneven();
  camera.keys[1].target.reset();
  camera.keys[1].orientation = Quat::Identity();
  const CameraTrack track = track_of(camera);
  EXPECT_LT(angle_between(turn(track, 0), look_at(kA, Vec3(0, 1, 0), Quat::Identity())), 1e-6);
  EXPECT_LT(angle_between(turn(track, 0.5), Quat::Identity()), 1e-6);
  EXPECT_LT(angle_between(turn(track, 3), look_at(kD, Vec3(0, 1, 0), Quat::Identity())), 1e-6);
}

TEST(KeyedCamera, TheLensNeverGoesBeyondItsKeys) {
  KeyedCamera camera = uneven();
  const double lenses[] = {0.4, 1.2, 1.2, 0.3};
  for (std::size_t i = 0; i < 4; ++i) camera.keys[i].field_of_view = lenses[i];
  const CameraTrack track = track_of(camera);
  for (int f = 0; f < track.frame_count(); ++f) {
    const double t = f / 100.0;
    EXPECT_GE(lens(track, t), 0.3 - 1e-6);
    EXPECT_LE(lens(track, t), 1.2 + 1e-6);
    if (t >= 0.5 && t <= 2) {
      EXPECT_NEAR(lens(track, t), 1.2, 1e-6);
    }
  }
  // A key without one takes no part; none at all is 45 degrees.
  camera.keys[1].field_of_view.reset();
  camera.keys[2].field_of_view.reset();
  EXPECT_NEAR(lens(track_of(camera), 1.5), 0.35, 1e-6);
  EXPECT_NEAR(lens(track_of(uneven()), 1.5), kPi / 4, 1e-7);
}

TEST(KeyedCamera, RollTurnsAboutTheDirection) {
  KeyedCamera camera = uneven();
  for (CameraKey& key : camera.keys) key.roll = 0.5;
  const CameraTrack level = track_of(uneven()), tilted = track_of(camera);
  for (const double t : {0.0, 1.0, 3.0}) {
    EXPECT_NEAR(angle_between(turn(level, t), turn(tilted, t)), 0.5, 1e-6);
    EXPECT_LT((turn(level, t) * Vec3::UnitZ() - turn(tilted, t) * Vec3::UnitZ()).norm(), 1e-6);
  }
}

TEST(KeyedCamera, OverATargetItDoesNotTurnOver) {
  // Passing exactly over what it looks at, in one frame.
  KeyedCamera camera{{key_at(0, {0, 5, 0}, Vec3::Zero()), key_at(1, {0, 5, 0}, {0, 0, -1})}};
  for (CameraKey& key : camera.keys) key.between = Between::linear;
  const CameraTrack track = track_of(camera);
  EXPECT_LT(camera_motion(track).largest_turning, 0.21);
}

TEST(KeyedCamera, TheLastFrameHoldsTheLastKey) {
  KeyedCamera camera{{key_at(0.2, kA), key_at(1.01, kB)}};
  const CameraTrack track = track_of(camera, 10);
  ASSERT_EQ(track.frame_count(), 12);
  EXPECT_EQ(track.positions[0], kA.cast<float>());  // before the first key it holds
  EXPECT_EQ(track.positions[11], kB.cast<float>());
  const CameraTrack single = track_of({{key_at(0, kA)}}, 30);
  ASSERT_EQ(single.frame_count(), 1);
  EXPECT_EQ(single.positions[0], kA.cast<float>());
}

TEST(KeyedCamera, RefusesWhatMakesNoCamera) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [](const auto& change, double rate = 30) {
    KeyedCamera camera = uneven();
    change(camera);
    const auto track = make_track(camera, rate);
    return track ? std::string("none") : track.error().code;
  };
  EXPECT_EQ(code([](KeyedCamera&) {}), "none");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys.clear(); }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[1].time = 0; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[0].time = -1; }), "camera-keys");
  EXPECT_EQ(code([nan](KeyedCamera& c) { c.keys[3].time = nan; }), "camera-keys");
  EXPECT_EQ(code([nan](KeyedCamera& c) { c.keys[2].position.x() = nan; }), "camera-keys");
  EXPECT_EQ(code([nan](KeyedCamera& c) { c.keys[2].target->y() = nan; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[2].target = c.keys[2].position; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[2].target.reset(); }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[2].orientation = Quat::Identity(); }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) {
              c.keys[2].target.reset();
              c.keys[2].orientation = Quat(0, 0, 0, 0);
            }),
            "camera-keys");
  EXPECT_EQ(code([nan](KeyedCamera& c) { c.keys[2].tension = nan; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[2].tension = 1.5; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[2].field_of_view = 4; }), "camera-keys");
  EXPECT_EQ(code([](KeyedCamera& c) {
              c.closed = true;
              c.keys[1].between = Between::linear;
            }),
            "camera-keys");
  EXPECT_EQ(code([](KeyedCamera&) {}, 0), "camera-rate");
  EXPECT_EQ(code([nan](KeyedCamera&) {}, nan), "camera-rate");
  EXPECT_EQ(code([](KeyedCamera&) {}, 1e9), "camera-rate");
  EXPECT_EQ(code([](KeyedCamera& c) { c.keys[3].position.x() = 1e300; }), "camera-keys");
}

// Else a cut is flown through, and its lens zooms while the picture is to hold still.
TEST(KeyedCamera, AStepEndsInACut) {
  KeyedCamera camera = {{key_at(0, kA), key_at(1, kB), key_at(2.004, kC), key_at(3, kD)}};
  camera.keys[0].between = camera.keys[2].between = Between::linear;
  camera.keys[1].between = Between::step;
  camera.keys[0].field_of_view = 0.5;
  camera.keys[3].field_of_view = 1.5;
  const CameraTrack track = track_of(camera);
  EXPECT_EQ(track.cuts, (std::vector<int>{201}));
  EXPECT_NEAR(lens(track, 1.0), lens(track, 2.0), 1e-6);
  EXPECT_GT(lens(track, 2.01), lens(track, 2.0) + 0.3);
  EXPECT_LT(camera_motion(track).largest_speed, (kC - kD).norm() / 0.996 + 0.01);
  camera.keys = {camera.keys[0], camera.keys[1]};
  camera.keys[0].between = Between::step;
  camera.keys[1].time = 0.001;  // the last frame, at 0.01 s, holds it
  EXPECT_EQ(track_of(camera).cuts, (std::vector<int>{1}));
}

TEST(CameraMotion, IsTheFastestStep) {
  CameraTrack track;
  track.rate = 10;
  track.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0.1f, 0.5f, 0}};
  track.orientations = {Quatf::Identity(), Quatf(Eigen::AngleAxisf(0.3f, Vec3f::UnitX())),
                        Quatf(Eigen::AngleAxisf(0.4f, Vec3f::UnitX()))};
  track.orientations[1].coeffs() *= -1;
  track.fields_of_view = {1, 0.5f, 0.7f};
  const CameraMotion motion = camera_motion(track);
  EXPECT_NEAR(motion.length, 0.6, 1e-6);
  EXPECT_NEAR(motion.largest_speed, 5, 1e-6);
  EXPECT_EQ(motion.fastest_frame, 1);
  EXPECT_NEAR(motion.largest_turning, 3, 1e-5);
  EXPECT_EQ(motion.fastest_turning_frame, 0);
  EXPECT_FLOAT_EQ(static_cast<float>(motion.least_field_of_view), 0.5f);
  EXPECT_EQ(camera_motion(CameraTrack()).largest_speed, 0);
}

}  // namespace
}  // namespace krok
