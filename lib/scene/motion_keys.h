#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"

// The moments that give a motion its structure: when parts of the feet stand on something, and the
// keytimes by which motions are brought into step. They accompany a clip.

namespace krok {

// A joint that stays where it is, on the ground or on something else, from `start` to `end`.
struct Contact {
  int joint = 0;
  double start = 0, end = 0;  // seconds from the clip's first frame, start <= end
  Vec3 place = Vec3::Zero();  // where the joint stays, metres, world
};

// A moment with a name, such as "left_strike".
struct Keytime {
  double time = 0;  // seconds from the clip's first frame
  std::string name;
};

struct MotionKeys {
  std::vector<Contact> contacts;  // by start, then joint
  std::vector<Keytime> keytimes;  // by time, ascending

  bool empty() const { return contacts.empty() && keytimes.empty(); }
};

// What lies between two moments, `from` <= `to` (seconds), counted from the first; contacts that
// reach beyond are cut there.
MotionKeys part_of(const MotionKeys& keys, double from, double to);

// Whether `keys` fits a clip of `skeleton` that lasts `duration` seconds: joints exist, times are
// finite, ordered and within the clip (up to a millisecond beyond), places finite, keytimes rising
// by at least a microsecond with names that are not empty. Codes: keys-joint, keys-time,
// keys-place, keys-name.
Status check(const MotionKeys& keys, const Skeleton& skeleton, double duration);

}  // namespace krok
