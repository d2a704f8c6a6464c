#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "roles/roles.h"
#include "timeline/timeline.h"

// The animation controller, played to its end: a timeline becomes one motion.

namespace krok::timeline {

struct MixOptions {
  int jobs = 0;  // threads; 0: as many as processors
};

struct Event {
  enum class Kind : unsigned char { begin, end, loop, mark };
  Kind kind = Kind::begin;
  double time = 0;  // seconds of the result
  std::string item;
  std::string name;  // of a mark
  int layer = -1;    // -1: the base
  int index = 0;     // of the item in the base or the layer
  int round = 0;     // that begins with a loop, from 1 on
};

struct ItemFacts {
  std::string name;
  int layer = -1;
  double start = 0, end = 0;  // of its own first and last moment, in the result
  int rounds = 1;             // begun
  double skipped = 0;         // seconds of play that it begins with, so as to be in step
};

struct ChangeFacts {
  int item = 0;  // that is changed into, from 1 on
  ChangeKind kind = ChangeKind::cut;
  double begin = 0, end = 0;
  bool in_step = false;  // by keytimes
  bool on_feet = false;  // feet that stand kept it in place
  // The largest angle between rotations to the parent where it begins, from the one motion to the
  // other: what has to be bridged. Radians.
  double angle = 0;
  int angle_joint = 0;
  // The fastest turn of a joint in its parent, from the frame before it to the frame behind it, and
  // what 99 of 100 frames of both motions have for their fastest joint. Radians a second.
  double fastest = 0, usual = 0;
  int fastest_joint = 0, fastest_frame = 0;

  // One frame in a hundred of the motions is faster than usual, too.
  bool pops() const { return fastest > 1.1 * usual; }
};

struct Mixed {
  Clip clip;                     // without provenance
  MotionKeys keys;               // where they are known
  std::vector<Event> events;     // by time
  std::vector<ItemFacts> items;  // base first, then layer by layer
  std::vector<ChangeFacts> changes;
  Diagnostics warnings;  // seams of rounds that jump
};

// A frame that shows one motion alone, where that motion stands where it was captured, is that
// motion's frame bit for bit; joints that no layer moves are as if there were none. The keys are
// the base's: keytimes where its motions have them (of two that cross-fade the one that weighs
// more), contacts outside changes, and of joints that no layer moves meanwhile.
//
// Sources are of one skeleton: names, order and parents are the same. Codes: timeline-skeleton,
// timeline-empty (no item, or a motion without frames), timeline-limit; those of schedule() and of
// layers (timeline-source, -time, -endless, -sync, -mask, -weight); clip-rate, clip-too-long as
// frames_within(); those of check(Clip) and check(MotionKeys).
Result<Mixed> mix(const Timeline& timeline, std::span<const Source> sources, const RoleMap& roles,
                  const MixOptions& options = {});

}  // namespace krok::timeline
