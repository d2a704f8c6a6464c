#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <vector>

#include "body/human_actor.h"
#include "body/implicit.h"

namespace krok::body {

// The orientation of a hand in a pose, and its finger joints.
struct HandLayout {
  Vec3 along = Vec3::UnitX();   // unit, from the wrist to the knuckles
  Vec3 across = Vec3::UnitZ();  // unit, perpendicular to `along`, towards the thumb
  // Chains from knuckle to tip, at least two joints each, starting at the thumb side. Chains within
  // the wrist are left out.
  std::vector<std::vector<int>> fingers;
  std::vector<int> thumb;  // empty if there is none
  // Whether the skeleton has a complete hand. With fewer than three fingers they are placeholders.
  bool whole() const { return fingers.size() >= 3; }
};

HandLayout hand_layout(const Skeleton& skeleton, const HumanActor& actor, std::size_t side,
                       std::span<const Transform> pose);

// `pose` with the fingers of complete hands straightened and spread so that they do not touch.
std::vector<Transform> spread_fingers(const Skeleton& skeleton, const HumanActor& actor,
                                      std::span<const Transform> pose);

// The parts of the human shape; internal to the human_*.cpp files.

class HumanBuilder {
 public:
  HumanBuilder(const Skeleton& skeleton, const HumanActor& actor, std::span<const Transform> pose);
  Shape build();

 private:
  Vec3 position(int joint) const { return pose_[static_cast<std::size_t>(joint)].position; }
  int parent_outside(int joint) const {
    const int parent = skeleton_.parents[static_cast<std::size_t>(joint)];
    return parent < 0 ? joint : parent;
  }
  // The common parent joint of neck and arms.
  int chest_joint() const;
  std::vector<TubeJoint> joints_along(const std::vector<int>& path, const Vec3& origin,
                                      const Vec3& axis, double half_width) const;
  void push_path(Tube& tube, int from, int to, const Vec3& origin, const Vec3& axis, double arc,
                 double half_width) const;
  // A point given by its height above the hip joints and its offsets, as fractions of stature.
  Vec3 trunk_point(double height, double left, double forward) const;
  int add_ball(const Vec3& center, const Vec3& axes, double detail, int like);

  void build_trunk();
  struct HeadRow {
    double left, below_top, forward, width, depth, cap;
  };
  void place_head();
  Vec3 head_point(double left, double below_top, double forward) const;
  void build_neck();
  int add_head_tube(std::initializer_list<HeadRow> rows, double detail);
  void build_head();
  void build_face();
  void build_leg(std::size_t side);
  void build_foot(std::size_t side);
  void build_arm(std::size_t side);
  void build_hand(std::size_t side);
  void build_finger_along(std::size_t side, const HandLayout& hand, const std::vector<int>& chain);
  void build_free_finger(std::size_t side, const HandLayout& hand, int finger);
  void join();

  const Skeleton& skeleton_;
  const HumanActor& actor_;
  std::span<const Transform> pose_;
  double unit_;                // stature, metres
  std::vector<double> along_;  // [joints], distance from the root along the bones
  Shape shape_;

  Vec3 trunk_base_ = Vec3::Zero(), trunk_axis_ = Vec3::UnitY();
  double trunk_scale_ = 1, chest_scale_ = 1, hip_scale_ = 1;
  int head_ = 0;               // the joint that moves the head
  Vec3 crown_ = Vec3::Zero();  // the top of the head
  int trunk_ = 0, neck_ = 0, skull_ = 0, face_ = 0;
  std::vector<int> features_;  // of the face
  std::array<int, 2> glutes_{}, chest_{}, legs_{}, feet_{}, arms_{}, ridges_{}, palms_{}, ears_{};
  std::array<std::vector<int>, 2> fingers_;
};

}  // namespace krok::body
