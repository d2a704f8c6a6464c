#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// The range of a motion that an item plays, resolved. Play time is the seconds since the item's
// first frame at the item's own speed, through all loop rounds.
struct PlayedRange {
  int source = 0;
  double from = 0, to = 0;      // seconds of the source, from <= to
  double speed = 1;             // not 0
  double round = 0;             // duration of one round, seconds; 0 for a single held pose
  double rounds = 1;            // infinite if it repeats until ended
  bool loops_if_ended = false;  // repeats if something ends it later; otherwise plays once

  // Total play time, seconds; infinite if `rounds` is, and for a held pose.
  double duration() const;

  struct Moment {
    int round = 0;
    double time = 0;  // seconds of the source
  };
  // Round and source time at a play time, which is clamped to the duration. The end of a round is
  // the start of the next, except for the last.
  Moment at(double play_time) const;

  // The play time of a source time in a round; source times outside from .. to extrapolate.
  double play_time(int round, double source_time) const;
};

inline constexpr int kMaxRounds = 100'000;

// Resolves a Play. Codes timeline-source (no such source or part), timeline-time (outside the
// motion, end before start, invalid speed), timeline-limit (rounds); `where` is added by the
// caller.
Result<PlayedRange> resolve(const Play& play, std::span<const Source> sources);

// A keytime of the source at a play time.
struct PlayedKey {
  double play_time = 0;
  const Keytime* key = nullptr;
};

// The keytimes with play times in [low, high], increasing; none for backwards play, where heel
// strikes would become toe-offs. For a single round, keytimes outside from .. to are included: they
// give the gait phase at its ends. A keytime at the seam of two rounds is listed once. Stops after
// `most` + 1 keytimes.
std::vector<PlayedKey> played_keys(const PlayedRange& range, const MotionKeys& keys, double low,
                                   double high, std::size_t most);

}  // namespace krok::timeline
