#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant/follow_feet.h"
#include "plant/foot_paths_internal.h"
#include "plant/legs_internal.h"

// A foot that follows the foot of another actor. Used by follow_feet().

namespace krok::plant {

// A foot in the frame of its joint.
struct SoleShape {
  int foot = -1;
  Vec3 heel = Vec3::Zero(), ball = Vec3::Zero();
  Vec3 up = Vec3::UnitY();       // normal of the sole, unit vector
  Vec3 forward = Vec3::UnitZ();  // from heel to ball along the sole, unit vector
  double tip = 0;                // metres along the sole, from the heel to the tip of the toes

  double length() const { return (ball - heel).dot(forward); }
  double ball_height() const { return (ball - heel).dot(up); }
  Quat axes() const;  // sole_to_foot: x to the left, y up, z ahead
};

// A stance, in frames, both included.
struct Standing {
  int first = 0, last = 0;
  std::array<int, 2> heel = {0, -1}, ball = {0, -1};  // empty where last < first
  Vec3 up = Vec3::UnitY();                            // of the ground, world, unit vector
  Vec3 of_heel = Vec3::Zero(),
       of_ball = Vec3::Zero();  // from the source's point to its own, metres
  Vec3 tilt = Vec3::Zero();  // rotation vector from the source's sole to its own, where the ground
                             // is not even
  double height = 0;         // metres, of the source's heel and ball
};

class SoleFollower {
 public:
  // The source's foot. Code plant-contacts where it never stands, contacts-feet where it is not
  // known.
  static Result<SoleFollower> create(const Clip& source, const RoleMap& source_roles, FootSide side,
                                     const GroundBelow& ground, std::span<const Contact> contacts);

  // Sets the foot that follows, in a clip that has been moved over the source, `beside` metres
  // farther to its side in all stances. Code contacts-feet.
  Status lead_foot(const Clip& clip, const Leg& leg, double beside, const GroundBelow& ground);

  // The correction that brings that foot to its places.
  FootPath path(const Clip& clip) const;

  // Height of the ground in a stance, interpolated between stances.
  double standing_height(int frame) const;

  void add_contacts(const Clip& clip, std::vector<Contact>& contacts) const;
  void measure(const Clip& clip, const GroundBelow& ground, FollowedFeet& into) const;

 private:
  // The point of the sole that is placed, from 0 (heel) to 1 (ball), and its offset from the
  // source's.
  struct Lead {
    double along = 0;
    Vec3 off = Vec3::Zero();
    Vec3 tilt = Vec3::Zero();
  };
  Lead lead(int frame) const;
  static Lead lead_at(const Standing& standing, double along);
  static Lead lead_in(const Standing& standing, int frame);
  void find_standings(std::span<const Contact> contacts, const SolePoint& heel,
                      const SolePoint* ball);
  void place(Standing& standing, double beside, const GroundBelow& ground) const;
  // From the other hip of the source to the foot's, the mean over a stance, horizontal.
  Vec3 across_hips(const Standing& standing) const;
  // How badly the sole lies with its heel there; 0 is good.
  double trouble_at(const Vec3& heel, const Vec3& forward, const GroundBelow& ground) const;

  const Clip* source_ = nullptr;
  int hip_ = -1, other_hip_ = -1;  // of the source
  Leg leg_;
  SoleShape theirs_, own_;
  std::vector<Standing> standings_;
  std::vector<int> flat_;  // frames in which the source's foot is flat
};

}  // namespace krok::plant
