#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "roles/roles.h"
#include "timeline/timeline.h"

// Evaluates a timeline into one motion.

namespace krok::timeline {

struct MixOptions {
  int jobs = 0;  // threads; 0: one per processor
};

struct Event {
  enum class Kind : unsigned char { begin, end, loop, mark };
  Kind kind = Kind::begin;
  double time = 0;  // seconds of the result
  std::string item;
  std::string name;  // of a mark
  int layer = -1;    // -1: the base
  int index = 0;     // of the item in the base or the layer
  int round = 0;     // of a loop: the round that begins, from 1 on
};

struct ItemFacts {
  std::string name;
  int layer = -1;
  double start = 0, end = 0;  // seconds of the result
  int rounds = 1;             // rounds started
  double skipped = 0;         // play time at its start, from time alignment, seconds
};

// How fast the hips and the feet (ankles and balls) go through the world, and how hard they are
// accelerated: metres per second, or per second squared.
enum PaceOf : std::size_t { hips_speed, feet_speed, hips_acceleration, feet_acceleration };
constexpr std::size_t kPaces = 4;
struct Pace {
  double most = 0;
  double usual = 0;  // the 99th percentile over the frames of a motion, the larger of both motions'
  int joint = 0, frame = 0;
};

// The pace that is furthest beyond what is usual; nothing where none is beyond it. Allowed are 1.5
// times the usual speed, as a figure may catch up with an offset, and 2.5 times the usual
// acceleration, of which a few frames have far more than all others; 0.3 m/s and 10 m/s² always.
std::optional<PaceOf> worst_pace(const std::array<Pace, kPaces>& paces);

struct ChangeFacts {
  int item = 0;  // index of the next item, from 1 on
  ChangeKind kind = ChangeKind::cut;
  double begin = 0, end = 0;
  bool in_step = false;  // time-aligned by keytimes
  bool on_feet = false;  // positioned by feet in contact
  // The largest angle between the local rotations of a joint in the two motions where the change
  // begins, radians.
  double angle = 0;
  int angle_joint = 0;
  // The largest local angular velocity of a joint, from the frame before the change to the frame
  // after it, and the 99th percentile, over the frames of a motion, of that of its fastest joint:
  // the larger of the two motions. Radians per second.
  double fastest = 0, usual = 0;
  int fastest_joint = 0, fastest_frame = 0;

  std::array<Pace, kPaces> paces;  // by PaceOf; they jump where angles tell nothing

  // Whether joints turn, or the hips or feet go, faster than in the motions.
  bool pops() const { return turns_too_fast() || worst_pace(paces).has_value(); }
  // Allows 10 % because one frame in a hundred of the motions exceeds `usual` too.
  bool turns_too_fast() const { return fastest > 1.1 * usual; }
};

struct Mixed {
  Clip clip;                     // without provenance
  MotionKeys keys;               // where known
  std::vector<Event> events;     // by time
  std::vector<ItemFacts> items;  // base first, then layer by layer
  std::vector<ChangeFacts> changes;
  Diagnostics warnings;  // loops with a jump, layers that pop, marks never reached
};

// Outside changes, a frame of a motion that is not repositioned equals the source frame bit for
// bit, joints above the hips aside: a root that stands in all motions stands where it does in the
// first (HipsRoot). Layers do not change joints that they do not move. The keys are those of the
// base: keytimes of its motions (in a crossfade, of the motion with the larger weight), and
// contacts outside changes of joints that no layer moves at that time.
//
// All sources need the same skeleton: names, order and parents. Codes: timeline-skeleton,
// timeline-empty (no item, or a motion without frames), timeline-limit; those of schedule() and of
// layers (timeline-source, -time, -endless, -sync, -mask, -weight); clip-rate, clip-too-long as
// frames_within(); those of check(Clip) and check(MotionKeys).
Result<Mixed> mix(const Timeline& timeline, std::span<const Source> sources, const RoleMap& roles,
                  const MixOptions& options = {});

}  // namespace krok::timeline
