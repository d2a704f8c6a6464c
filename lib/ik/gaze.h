#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/clip.h"

// Eyes and head that turn to what is looked at.
//
// A gaze shift of amplitude A from straight ahead: the head turns by head_share(A), the eyes by the
// rest. The eyes jump (a saccade of 21 ms + 2.2 ms per degree: Carpenter, Movements of the Eyes,
// 1988, along a minimum-jerk profile), the head follows by kHeadLag and takes longer, and the eyes
// turn back as it arrives, so that the gaze stays on its target. Eyes keep within their ranges: the
// head turns further where these are too narrow. An eye turns about the axis that takes it there
// straight from looking ahead (Listing's law).

namespace krok::ik {

// Of a gaze shift of an angle in radians, >= 0, that begins with centred eyes, how far the head
// turns. Source: Freedman and Sparks, Eye-head coordination during head-unrestrained gaze shifts in
// rhesus monkeys (J. Neurophysiol. 77, 1997): none below 20 degrees, then linear up to 90, where
// eyes saturate at 35.
double head_share(double amplitude);

// After the eyes. Source: 50 ms at 40 degrees in people (Practica oto-rhino-laryngologica 24,
// supplement 2, 1978, pp. 559).
inline constexpr double kHeadLag = 0.05;  // seconds

struct GazeEye {
  std::string name;           // of its joint
  int joint = -1;             // of the motion; -1: to be added
  int carrier = 0;            // the joint it moves with, if it is added
  Vec3 place = Vec3::Zero();  // metres, in the frame of the carrier
  Character::EyeRange range;  // degrees
};

// The eyes of a character, whose model has the skeleton `model`, in a motion: as joints of their
// own (named as eye_joint_name(), or standing where a joint of the motion called an eye does), or
// to be added. Without a character's eyes, those that find_eyes() finds in the motion. Code
// gaze-eyes: there are none, or their joint is not in the motion.
Result<std::vector<GazeEye>> gaze_eyes(std::span<const Character::Eye> eyes, const Skeleton& model,
                                       const Skeleton& motion);

struct GazeTarget {
  double time = 0;            // seconds, when the eyes begin to turn to it
  std::optional<Vec3> point;  // metres, in the world; empty: straight ahead
};

struct GazeFacts {
  double amplitude = 0;  // of the shift, as the eyes begin it; radians
  double head = 0;       // how far the head is turned when the next shift begins, or at the end
  double missed = 0;     // by the worse eye then
  bool reached = true;   // the eyes' ranges allow it
};

struct GazeMotion {
  Clip clip;  // with joints added to the end for eyes that had none
  std::vector<GazeFacts> targets;
};

// Turns head, neck and eyes of a motion; without roles, the joint that carries the eyes is the
// head. Joints that nothing turns stay bit for bit. Times must
// increase, at least one eye. Codes: gaze-eyes, gaze-time, gaze-head for eyes at the root.
Result<GazeMotion> apply_gaze(const Clip& clip, std::span<const GazeEye> eyes,
                              std::span<const GazeTarget> targets, const RoleMap& roles);

}  // namespace krok::ik
