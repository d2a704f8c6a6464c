#pragma once

#include <functional>
#include <optional>
#include <vector>

// Stances of a foot, and its turning points relative to the pelvis.

namespace krok::contacts {

inline constexpr double kUsualLeg = 0.86;   // metres, hip to ankle
inline constexpr double kUsualCycle = 1.1;  // seconds

struct Stance {
  double start = 0, end = 0;  // seconds
  bool open_start = false, open_end = false;
  bool slides = false;  // found without a contact
};

// Times, in seconds, at which a foot is furthest ahead of and behind the pelvis.
struct Seeds {
  std::vector<double> front, back;
};

// Turning points of a curve (metres, [frames]) that differ by more than `least` from one to the
// next.
Seeds turning_points(const std::vector<double>& curve, double rate, double least);

// Median time from a seed to the next of its kind, seconds, clamped to 0.4 .. 2.5; kUsualCycle if
// there is none.
double cycle_of(const Seeds& seeds);

// Whether the foot swings at a time, so that every event has a seed: the seeds around it are less
// than a cycle apart.
bool is_seeded(const Seeds& seeds, double time, double cycle);

// Matches a foot's strikes or toe-offs, as found from contacts, with the seeds.

// Seconds after the foot's turning points; for toe-offs also after the toes' own.
inline constexpr double kStrikeAfterFront = 0.03, kOffAfterBack = 0.01, kOffAfterToes = -0.01;

// Statistics of the time from seeds to events of one kind, over both feet.
struct Offset {
  double usual, spread = 0;  // seconds, median and median absolute deviation
  bool known = false;
  bool jittery = false;
  bool scattered = false;  // too much to predict an event without a contact from its seed

  // Weight, 0 to 1, of an event from contacts against its prediction from the seed, `apart` seconds
  // away: 1 if the offsets are as consistent as people's steps or the capture is clean, small if
  // jitter scatters them, 0 for outliers.
  double weight_of(double apart) const;
};

// `usual` is used if there are no offsets or they scatter.
Offset offset_of(std::vector<double> offsets, double usual, bool jittery);

struct Events {
  std::vector<double> times;  // ascending
  int from_seeds = 0;
};

struct Pairing {
  const std::vector<double>* seeds = nullptr;  // of this kind of event
  const Seeds* all = nullptr;
  std::vector<double> events;                     // from contacts
  std::vector<std::optional<std::size_t>> event;  // [seeds], index into events; set by pair()
  std::vector<Stance> stances;
  double cycle = kUsualCycle;
  // Whether the foot is down near a seed.
  std::function<bool(double seed)> is_low;
  // When a foot that rolls off over its toes leaves the ground at a seed; nullopt if it does not
  // roll off. May be empty.
  std::function<std::optional<double>(double seed)> rolls_off;
  // Whether the positions of the foot at two times differ.
  std::function<bool(double from, double to)> moves;
  // Whether contacts do not show toe-off: the foot has no point for the toes, or its contacts end
  // long before toe-off in walking (a joint that is not animated does not bend with the toes).
  bool toes_unseen = false;

  void pair();
  void add_offsets(std::vector<double>& offsets) const;
  // By how many seconds contacts end before the toe-off of a foot that rolls off.
  void add_early(std::vector<double>& early) const;
  Events events_with(const Offset& offset) const;

 private:
  bool stands_at(double time) const;
};

// Whether contacts end so early that they do not show the toes.
bool leave_early(const std::vector<double>& early);

}  // namespace krok::contacts
