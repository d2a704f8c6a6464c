#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// The stretch of a motion that an item plays, in numbers. Play time counts the seconds since the
// item's first frame at the item's own speed, through all rounds.
struct PlayedRange {
  int source = 0;
  double from = 0, to = 0;      // seconds of the source, from <= to
  double speed = 1;             // not 0
  double round = 0;             // seconds that one round lasts; 0 where a single pose is held
  double rounds = 1;            // infinite where it goes on until it is ended
  bool loops_if_ended = false;  // one round, or more where something ends it later

  // Seconds of play in all; infinite as `rounds` is, and for a pose that is held.
  double duration() const;

  struct Moment {
    int round = 0;
    double time = 0;  // seconds of the source
  };
  // Where it is at a play time, which is clamped to the duration. The end of a round is the
  // beginning of the next, but for the last.
  Moment at(double play_time) const;

  // The play time of a moment of the source in a round, however far outside from .. to.
  double play_time(int round, double source_time) const;
};

inline constexpr int kMaxRounds = 100'000;

// What a play means in numbers. Codes
// timeline-source (no such source or part), timeline-time (outside the motion, the end before the
// beginning, no speed), timeline-limit (rounds); `where` is added by the caller.
Result<PlayedRange> resolve(const Play& play, std::span<const Source> sources);

// A keytime of the source by play time.
struct PlayedKey {
  double play_time = 0;
  const Keytime* key = nullptr;
};

// The keytimes with play times in [low, high], rising; none where it plays backwards, for strikes
// would be lift-offs. Where only one round is played, those outside from .. to as well: they tell
// where in a step the ends are. A keytime at the seam of two rounds comes once. Ends when there are
// more than `most`.
std::vector<PlayedKey> played_keys(const PlayedRange& range, const MotionKeys& keys, double low,
                                   double high, std::size_t most);

}  // namespace krok::timeline
