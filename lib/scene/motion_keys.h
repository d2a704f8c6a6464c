#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "scene/skeleton.h"

// Foot contacts and the keytimes used for time alignment. They accompany a clip.

namespace krok {

// A contact: a joint that stays at one position, on the ground or on something else, from `start`
// to `end`.
struct Contact {
  int joint = 0;
  double start = 0, end = 0;  // seconds from the clip's first frame, start <= end
  Vec3 place = Vec3::Zero();  // position of the joint, metres, world space
};

// A named time, such as "left_strike".
struct Keytime {
  double time = 0;  // seconds from the clip's first frame
  std::string name;
};

struct MotionKeys {
  std::vector<Contact> contacts;  // sorted by start, then joint
  std::vector<Keytime> keytimes;  // sorted by time

  bool empty() const { return contacts.empty() && keytimes.empty(); }
};

// The part between two times, `from` <= `to` (seconds), with times relative to `from`; contacts
// that extend beyond are cut.
MotionKeys part_of(const MotionKeys& keys, double from, double to);

// Checks `keys` for a clip of `skeleton` that lasts `duration` seconds: joints exist, times are
// finite, ordered and within the clip (up to a millisecond beyond), contact positions are finite,
// keytimes increase by at least a microsecond and have names. Codes: keys-joint, keys-time,
// keys-place, keys-name.
Status check(const MotionKeys& keys, const Skeleton& skeleton, double duration);

}  // namespace krok
