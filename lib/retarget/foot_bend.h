#pragma once

#include <span>
#include <vector>

#include "math/transform.h"
#include "retarget/foot_points.h"
#include "retarget/pose_alignment.h"

// Toes and foot bent upwards, so that the toes do not go into the floor.

namespace krok::retarget {

// A point of a foot and how near it may come to the floor, metres.
struct FootPoint {
  BodyPoint point;
  double height = 0;

  // How much higher it is in a pose.
  double over(double floor, std::span<const Transform> pose) const {
    return point.in(pose).y() - floor - height;
  }
};

// The lowest of FootPoint::over(); the largest double without points.
double lowest_over(double floor, std::span<const FootPoint> points,
                   std::span<const Transform> pose);

// Radians by which toes and foot are bent for a needed angle: toes first, by up to 80 degrees, then
// the foot, by up to 60 where it is free.
struct BendAngles {
  double toes = 0, foot = 0;
};
BendAngles bend_angles(double needed, double free);

class FootBend {
 public:
  FootBend() = default;
  // Those of `points` that are of the toes are kept over the floor. A foot without toe joints is
  // never bent.
  FootBend(const Actor& actor, Role foot, std::span<const FootPoint> points);

  // The angle, radians, by which toes that are below `lowest`, a height in the world, have to be
  // bent. 0 for toes that point back, as of a foot that lies on its instep.
  double needed(double lowest, std::span<const Transform> pose) const;

  // Bends the toes, and the foot about the ankle.
  void bend(double toes, double foot, std::span<Transform> pose) const;
  // The rotation by which bend() turned the foot of a pose.
  Quat turn_of_foot(double foot, std::span<const Transform> pose) const;

 private:
  struct Toe {
    int joint = -1;
    std::vector<int> below;  // with the joint
    std::vector<FootPoint> points;
  };
  static void turn(const Quat& by, const std::vector<int>& joints, std::span<Transform> pose);

  int foot_ = -1;
  std::vector<int> below_foot_;  // with the foot
  Vec3 right_ = Vec3::UnitX();   // of the foot, in its frame
  std::vector<Toe> toes_;
};

}  // namespace krok::retarget
