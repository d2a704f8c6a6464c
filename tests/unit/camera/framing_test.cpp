// If these fail, part of what is to be framed is cut off, or the camera stands farther away than it
// must.

#include "camera/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "camera/look_at.h"

namespace krok {
namespace {

// Independent of the code under test: points on a ball, through the matrix that graphics uses.
bool points_inside(double fov, double aspect, const Vec3& eye, const Quat& orientation,
                   const Ball& ball, double edge) {
  Eigen::Isometry3d camera_to_world = Eigen::Isometry3d::Identity();
  camera_to_world.linear() = orientation.toRotationMatrix();
  camera_to_world.translation() = eye;
  const Eigen::Matrix4d view = camera_to_world.inverse().matrix();
  const double f = 1 / std::tan(fov / 2);
  for (int i = 0; i < 400; ++i) {  // evenly over the ball
    const double z = 1 - 2 * (i + 0.5) / 400, turn = i * 2.399963;
    const double r = std::sqrt(1 - z * z);
    const Vec3 point = ball.centre + ball.radius * Vec3(r * std::cos(turn), r * std::sin(turn), z);
    const Eigen::Vector4d seen = view * point.homogeneous();
    if (seen.z() > -1e-3) return false;
    if (std::abs(f / aspect * seen.x() / -seen.z()) > edge) return false;
    if (std::abs(f * seen.y() / -seen.z()) > edge) return false;
  }
  return true;
}

std::vector<Ball> some_balls(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.5, 1.5), size(0, 0.4);
  std::vector<Ball> balls;
  for (int i = 0; i < 12; ++i) {
    balls.push_back({Vec3(place(random), place(random), place(random)), size(random)});
  }
  return balls;
}

TEST(Framing, OneBallByHand) {
  // 90 degrees: a ball of radius r touches the edges at the distance r sqrt(2).
  const ImageExtent image = ImageExtent::of(kPi / 2, 1, 0);
  const std::vector<Ball> ball = {{Vec3::Zero(), 0.5}};
  EXPECT_NEAR(distance_to_frame(image, Quat::Identity(), Vec3::Zero(), ball), 0.5 * std::sqrt(2.0),
              1e-12);
  // Nearer than its own radius and the near plane it may never be, however wide the lens.
  const ImageExtent wide = ImageExtent::of(3.1, 1, 0);
  EXPECT_NEAR(distance_to_frame(wide, Quat::Identity(), Vec3::Zero(), ball), 0.55, 1e-9);
  EXPECT_EQ(distance_to_frame(image, Quat::Identity(), Vec3::Zero(), {}), 0);
}

TEST(Framing, AtItsDistanceAllIsInsideAndNotAnyNearer) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto balls = some_balls(seed);
    const double fov = 0.3 + 0.05 * seed, aspect = 0.5 + 0.1 * seed;
    const Quat orientation = looking_from(0.7 * seed, 0.1 * (static_cast<double>(seed) - 10));
    const ImageExtent image = ImageExtent::of(fov, aspect, 0);
    const Vec3 aim(0.1, 0.2, -0.1);
    const double distance = distance_to_frame(image, orientation, aim, balls);
    const Vec3 eye = aim + distance * (orientation * Vec3::UnitZ());
    bool all = true, all_nearer = true;
    const Vec3 nearer = aim + (distance - 0.05) * (orientation * Vec3::UnitZ());
    for (const Ball& ball : balls) {
      all = all && points_inside(fov, aspect, eye, orientation, ball, 1 + 1e-9);
      all_nearer = all_nearer && points_inside(fov, aspect, nearer, orientation, ball, 1);
    }
    EXPECT_TRUE(all) << seed;
    EXPECT_FALSE(all_nearer) << seed;
    EXPECT_TRUE(shows_all(image, eye, orientation, balls));
    EXPECT_FALSE(shows_all(image, nearer, orientation, balls));
  }
}

TEST(Framing, TheMarginStaysFree) {
  const auto balls = some_balls(3);
  const ImageExtent image = ImageExtent::of(0.7, 1.5, 0.1);
  const Quat orientation = looking_from(0.4, 0.2);
  const double distance = distance_to_frame(image, orientation, Vec3::Zero(), balls);
  for (const Ball& ball : balls) {
    EXPECT_TRUE(points_inside(0.7, 1.5, distance * (orientation * Vec3::UnitZ()), orientation, ball,
                              0.8 + 1e-9));
  }
}

TEST(Framing, TheTightPlaceTouchesOppositeEdges) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto balls = some_balls(seed);
    const double fov = 0.3 + 0.05 * seed, aspect = 0.5 + 0.1 * seed;
    const Quat orientation = looking_from(1.1 * seed, 0.05 * seed);
    const ImageExtent image = ImageExtent::of(fov, aspect, 0);
    CameraFit tight(image, orientation);
    for (const Ball& ball : balls) tight.add(ball);
    const Vec3 eye = tight.place();
    EXPECT_TRUE(shows_all(image, eye, orientation, balls)) << seed;
    for (const Ball& ball : balls) {
      EXPECT_TRUE(points_inside(fov, aspect, eye, orientation, ball, 1 + 1e-9)) << seed;
    }
    // No step forward, together with one to any side, keeps all of it in the picture.
    for (const Vec3& step : {Vec3(0, 0, -0.01), Vec3(0.01, 0, -0.01), Vec3(-0.01, 0, -0.01),
                             Vec3(0, 0.01, -0.01), Vec3(0, -0.01, -0.01)}) {
      EXPECT_FALSE(shows_all(image, eye + orientation * step, orientation, balls)) << seed;
    }
    EXPECT_GT(tight.nearest(), 0);
    EXPECT_GT(tight.farthest(), tight.nearest());
  }
  EXPECT_EQ(CameraFit(ImageExtent::of(1, 1, 0), Quat::Identity()).place(), Vec3::Zero());
}

}  // namespace
}  // namespace krok
