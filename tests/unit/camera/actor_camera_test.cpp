// If these fail, a camera that films a figure loses it, jerks, goes under the ground or through the
// figure.

#include "camera/actor_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "samples/generator/walk.h"
#include "scene/camera_track.h"

namespace krok {
namespace {

const Clip& walk() {
  static const Clip clip = samples::make_walk({})->clip;
  return clip;
}
const RoleMap& roles() {
  static const RoleMap map = find_roles(walk().skeleton);
  return map;
}
int joint(Role role) {
  return roles().joint(role);
}

// The part of the picture that a point reaches, 1 at its edge; by matrices as graphics has them.
double reach(const CameraTrack& track, int frame, const Vec3f& point, double aspect) {
  const auto f = static_cast<std::size_t>(frame);
  Eigen::Isometry3d camera_to_world = Eigen::Isometry3d::Identity();
  camera_to_world.linear() = track.orientations[f].cast<double>().toRotationMatrix();
  camera_to_world.translation() = track.positions[f].cast<double>();
  const Vec3 seen = camera_to_world.inverse() * point.cast<double>();
  if (seen.z() > -0.05) return std::numeric_limits<double>::infinity();
  const double scale = 1 / std::tan(static_cast<double>(track.fields_of_view[f]) / 2);
  return std::max(std::abs(scale / aspect * seen.x()), std::abs(scale * seen.y())) / -seen.z();
}

double largest_reach(const CameraTrack& track, const Clip& clip, double aspect) {
  double largest = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const Vec3f& point : clip.frame_positions(f)) {
      largest = std::max(largest, reach(track, f, point, aspect));
    }
  }
  return largest;
}

ActorShot shot_of(const ActorCamera& camera, const Clip& clip = walk()) {
  auto shot = film(clip, find_roles(clip.skeleton), camera);
  EXPECT_TRUE(shot.ok()) << (shot ? "" : shot.error().message);
  return shot ? *shot : ActorShot();
}

struct Way {
  const char* name;
  ActorCamera camera;
};

std::vector<Way> ways() {
  std::vector<Way> all;
  const auto add = [&](const char* name, const auto& change) {
    ActorCamera camera;
    camera.joint = joint(Role::hips);
    camera.elevation = 0.15;
    change(camera);
    all.push_back({name, camera});
  };
  add("follow", [](ActorCamera&) {});
  add("head", [](ActorCamera& c) { c.joint = joint(Role::head); });
  add("upright picture", [](ActorCamera& c) { c.aspect = 9.0 / 16; });
  add("long lens", [](ActorCamera& c) { c.field_of_view = 0.1; });
  add("wide lens", [](ActorCamera& c) { c.field_of_view = 2.2; });
  add("orbit", [](ActorCamera& c) { c.turning = 2; });
  add("orbit of all", [](ActorCamera& c) { c.turning = -1, c.joint = -1; });
  add("behind", [](ActorCamera& c) { c.azimuth = kPi, c.azimuth_from = AzimuthFrom::actor; });
  add("still", [](ActorCamera& c) { c.joint = -1; });
  add("still top", [](ActorCamera& c) { c.joint = -1, c.elevation = kPi / 2; });
  add("from below", [](ActorCamera& c) { c.elevation = -0.8; });
  add("still below", [](ActorCamera& c) { c.elevation = -0.8, c.joint = -1; });
  add("lazy", [](ActorCamera& c) { c.dead_zone = 0.5; });
  add("hard", [](ActorCamera& c) { c.smoothing = 0; });
  return all;
}

TEST(ActorCamera, TheWholeActorIsInTheImageInAllFrames) {
  for (const auto& [name, camera] : ways()) {
    const ActorShot shot = shot_of(camera);
    ASSERT_EQ(shot.track.frame_count(), walk().frame_count()) << name;
    EXPECT_EQ(shot.track.rate, walk().rate);
    const double reached = largest_reach(shot.track, walk(), camera.aspect);
    // Joints lie within the margin by the flesh about them, and the picture is used.
    EXPECT_LT(reached, 1 - 2 * camera.margin) << name;
    EXPECT_GT(reached, 0.5) << name;
    EXPECT_EQ(shot.frames_shown, walk().frame_count()) << name;
    EXPECT_EQ(shot.first_not_shown, -1) << name;
    EXPECT_EQ(shot.frames_inside, 0) << name;
    EXPECT_TRUE(check(shot.track).ok()) << name;
  }
}

TEST(ActorCamera, StaysAboveTheGround) {
  double ground = 1e9;
  for (const int j : foot_joints(walk().skeleton, roles())) {
    for (int f = 0; f < walk().frame_count(); ++f) {
      ground = std::min(
          ground, static_cast<double>(walk().frame_positions(f)[static_cast<std::size_t>(j)].y()));
    }
  }
  for (const auto& [name, camera] : ways()) {
    for (const Vec3f& eye : shot_of(camera).track.positions) {
      EXPECT_GT(static_cast<double>(eye.y()), ground + kClearance - 1e-5) << name;
    }
  }
}

TEST(ActorCamera, PartsFillMoreOfTheImage) {
  ActorCamera camera;
  camera.joint = joint(Role::head);
  const double full = shot_of(camera).distance;
  camera.framing = Framing::upper;
  const ActorShot upper = shot_of(camera);
  camera.framing = Framing::head;
  const ActorShot head = shot_of(camera);
  EXPECT_LT(upper.distance, 0.8 * full);
  EXPECT_LT(head.distance, 0.5 * upper.distance);
  for (int f = 0; f < walk().frame_count(); ++f) {
    const auto points = walk().frame_positions(f);
    const auto at = [&](Role role) { return points[static_cast<std::size_t>(joint(role))]; };
    EXPECT_LT(reach(head.track, f, at(Role::head), camera.aspect), 1);
    EXPECT_LT(reach(upper.track, f, at(Role::left_hand), camera.aspect), 1);
    EXPECT_LT(reach(upper.track, f, at(Role::hips), camera.aspect), 1);
    EXPECT_GT(reach(upper.track, f, at(Role::left_foot), camera.aspect), 0.9);
    EXPECT_GT(reach(head.track, f, at(Role::hips), camera.aspect), 1);
  }
}

TEST(ActorCamera, SmoothingTakesTheStepsOutOfItsWay) {
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  camera.smoothing = 0;
  const CameraTrack hard = shot_of(camera).track;
  camera.smoothing = 0.5;
  const CameraTrack soft = shot_of(camera).track;
  const auto bounce = [](const CameraTrack& track) {
    double sum = 0;
    for (std::size_t i = 1; i < track.positions.size(); ++i) {
      sum += std::abs(static_cast<double>(track.positions[i].y() - track.positions[i - 1].y()));
    }
    return sum;
  };
  EXPECT_LT(bounce(soft), 0.2 * bounce(hard));
  // It does not lag: over the whole way it is where the unsmoothed one is.
  Vec3f apart = Vec3f::Zero();
  for (std::size_t i = 0; i < soft.positions.size(); ++i) {
    apart += (soft.positions[i] - hard.positions[i]) / static_cast<float>(soft.positions.size());
  }
  EXPECT_LT(apart.norm(), 0.05f);
}

TEST(ActorCamera, GoesRoundAsFastAsAskedAndTheWayAsked) {
  ActorCamera camera;  // about the middle of all
  camera.turning = 0.7;
  const ActorShot shot = shot_of(camera);
  const CameraMotion motion = camera_motion(shot.track);
  EXPECT_NEAR(motion.largest_turning, 0.7, 1e-3);
  EXPECT_NEAR(motion.largest_speed, 0.7 * shot.distance, 1e-3 * shot.distance + 1e-3);
  // Counter-clockwise seen from above: from +Z (the front) towards +X.
  EXPECT_GT(shot.track.positions[10].x(), shot.track.positions[0].x());
  camera.turning = -0.7;
  EXPECT_LT(shot_of(camera).track.positions[10].x(), shot_of(camera).track.positions[0].x());
}

TEST(ActorCamera, LooksFromWhereTheActorFaces) {
  Clip turned = walk();
  move_clip(turned_about_start(turned, joint(Role::hips), 1.1), turned);
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  const double heading = ground_frame(turned, camera.joint, 0).heading;
  const Vec3f from = shot_of(camera, turned).track.orientations[0] * Vec3f::UnitZ();
  EXPECT_NEAR(std::atan2(from.x(), from.z()), heading, 1e-5);
  camera.azimuth_from = AzimuthFrom::world;
  const Vec3f world = shot_of(camera, turned).track.orientations[0] * Vec3f::UnitZ();
  EXPECT_NEAR(std::atan2(world.x(), world.z()), 0, 1e-5);
}

TEST(ActorCamera, FollowsTheFacingOfAActorThatTurnsRound) {
  // One full turn on the spot and more, so that the heading wraps.
  Clip spin;
  spin.skeleton = walk().skeleton;
  spin.rate = 30;
  spin.resize(121);
  for (int f = 0; f < 121; ++f) {
    const Transform turn{Vec3::Zero(), Quat(Eigen::AngleAxisd(f * 8.0 / 120, Vec3::UnitY()))};
    std::vector<Transform> pose = spin.skeleton.reference;
    for (Transform& one : pose) one = turn * one;
    spin.set_pose(f, pose);
  }
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  camera.azimuth_from = AzimuthFrom::actor;
  const ActorShot shot = shot_of(camera, spin);
  EXPECT_EQ(shot.frames_shown, 121);
  const CameraMotion motion = camera_motion(shot.track);
  EXPECT_NEAR(motion.largest_turning, 2.0, 0.02);  // 8 rad in 4 s, evenly
}

// Would fail if the camera whipped round with an actor that turns about in a third of a second.
TEST(ActorCamera, TurnsWithTheActorAtNoMoreThanNinetyDegreesASecond) {
  Clip about;
  about.skeleton = walk().skeleton;
  about.rate = 30;
  about.resize(241);
  for (int f = 0; f < 241; ++f) {
    const double turned = kPi * std::clamp((f - 120) / 10.0, 0.0, 1.0);
    const Transform turn{Vec3::Zero(), Quat(Eigen::AngleAxisd(turned, Vec3::UnitY()))};
    std::vector<Transform> pose = about.skeleton.reference;
    for (Transform& one : pose) one = turn * one;
    about.set_pose(f, pose);
  }
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  camera.azimuth_from = AzimuthFrom::actor;
  const ActorShot shot = shot_of(camera, about);
  EXPECT_LE(camera_motion(shot.track).largest_turning, 0.5 * kPi + 0.01);
  EXPECT_GT(camera_motion(shot.track).largest_turning, 1);
}

TEST(ActorCamera, TheDeadZoneLeavesSmallMotionAlone) {
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  camera.smoothing = 0;
  camera.dead_zone = 100;
  EXPECT_LT(camera_motion(shot_of(camera).track).largest_speed, 1e-9);
  camera.dead_zone = 0.3;
  const CameraTrack lazy = shot_of(camera).track;
  EXPECT_EQ(lazy.positions[0], lazy.positions[5]);
  EXPECT_NE(lazy.positions[0], lazy.positions[lazy.positions.size() - 1]);
}

TEST(ActorCamera, KeepsAGivenDistanceAndCountsWhatIsCut) {
  ActorCamera camera;
  camera.joint = joint(Role::hips);
  camera.distance = 1.5;
  const ActorShot near = shot_of(camera);
  EXPECT_EQ(near.distance, 1.5);
  EXPECT_EQ(near.frames_shown, 0);
  EXPECT_EQ(near.first_not_shown, 0);
  EXPECT_EQ(near.frames_inside, 0);
  camera.distance = 0.05;
  EXPECT_EQ(shot_of(camera).frames_inside, walk().frame_count());
  camera.distance = 12;
  EXPECT_EQ(shot_of(camera).frames_shown, walk().frame_count());
}

TEST(ActorCamera, FilmsOneFrameAndOneJoint) {
  Clip lone;
  lone.skeleton.add("only", Skeleton::kNoParent, {Vec3(1, 2, 3), Quat::Identity()});
  lone.resize(1);
  lone.set_pose(0, lone.skeleton.reference);
  for (const int followed : {0, -1}) {
    ActorCamera camera;
    camera.joint = followed;
    const ActorShot shot = shot_of(camera, lone);
    ASSERT_EQ(shot.track.frame_count(), 1);
    EXPECT_EQ(shot.frames_shown, 1);
    EXPECT_EQ(shot.frames_inside, 0);
    EXPECT_GT((shot.track.positions[0] - Vec3f(1, 2, 3)).norm(), 0.05f);
  }
}

TEST(ActorCamera, RefusesWhatItCannotFilm) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [](const auto& change, const Clip& clip) {
    ActorCamera camera;
    camera.joint = 0;
    change(camera);
    const auto shot = film(clip, find_roles(clip.skeleton), camera);
    return shot ? std::string("none") : shot.error().code;
  };
  const auto of_walk = [&](const auto& change) { return code(change, walk()); };
  EXPECT_EQ(of_walk([](ActorCamera&) {}), "none");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.joint = 1000; }), "camera-value");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.field_of_view = 0; }), "camera-value");
  EXPECT_EQ(of_walk([nan](ActorCamera& c) { c.field_of_view = nan; }), "camera-value");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.aspect = -1; }), "camera-value");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.margin = 0.5; }), "camera-value");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.elevation = 2; }), "camera-value");
  EXPECT_EQ(of_walk([nan](ActorCamera& c) { c.azimuth = nan; }), "camera-value");
  EXPECT_EQ(of_walk([nan](ActorCamera& c) { c.dead_zone = nan; }), "camera-value");
  EXPECT_EQ(of_walk([](ActorCamera& c) { c.distance = -1; }), "camera-value");
  Clip empty;
  EXPECT_EQ(code([](ActorCamera& c) { c.joint = -1; }, empty), "camera-empty");
  empty.skeleton = walk().skeleton;
  EXPECT_EQ(code([](ActorCamera&) {}, empty), "camera-empty");
  Clip stick;
  stick.skeleton.add("a", Skeleton::kNoParent, {});
  stick.resize(1);
  stick.set_pose(0, stick.skeleton.reference);
  EXPECT_EQ(code([](ActorCamera& c) { c.framing = Framing::head; }, stick), "camera-part");
  EXPECT_EQ(code([](ActorCamera& c) { c.framing = Framing::upper; }, stick), "camera-part");
  // A joint that flies away farther than any camera goes.
  Clip far = walk();
  far.positions[far.positions.size() - 3] = Vec3f(1e9f, 0, 0);
  EXPECT_EQ(code([](ActorCamera&) {}, far), "camera-frame");
}

}  // namespace
}  // namespace krok
