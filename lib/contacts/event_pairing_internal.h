#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "contacts/gait_seeds_internal.h"

// What contacts show of a foot's strikes, or of its offs, held against the seeds.

namespace krok::contacts {

// Seconds after the foot's turning points, and of an off after the toes' own.
inline constexpr double kStrikeAfterFront = 0.03, kOffAfterBack = 0.01, kOffAfterToes = -0.01;

// What the pairs of seeds and events of one kind have in common, over both feet.
struct Offset {
  double usual, spread = 0;  // seconds, median and median deviation
  bool known = false;
  bool jittery = false;
  bool scattered = false;  // too much for a seed to tell an event that no contact shows

  // How much what the contacts show counts beside what the seeds let expect: all of it where they
  // agree as well as people's steps are alike or the capture is clean, little where jitter scatters
  // it, nothing where it lies far off.
  double weight_of(double apart) const;
};

// `usual` is for where there are no offsets to tell it, or they scatter.
Offset offset_of(std::vector<double> offsets, double usual, bool jittery);

struct Events {
  std::vector<double> times;  // ascending
  int from_seeds = 0;
};

struct Pairing {
  const std::vector<double>* seeds = nullptr;  // of this kind of event
  const Seeds* all = nullptr;
  std::vector<double> events;                     // as contacts show them
  std::vector<std::optional<std::size_t>> event;  // of each seed, set by pair()
  std::vector<Stance> stances;
  double cycle = kUsualCycle;
  // Whether the foot is down beside a seed.
  std::function<bool(double seed)> is_low;
  // When a foot that rolls off over its toes leaves the ground at a seed, or nothing where it does
  // not; may be empty.
  std::function<std::optional<double>(double seed)> rolls_off;
  // Whether the foot is elsewhere at one moment than at another.
  std::function<bool(double from, double to)> moves;
  // Whether nothing shows when its toes leave: it has no point for them, or, by what the contacts
  // show, they leave long before they do so in walking (a joint that stands still does not bend
  // with them).
  bool toes_unseen = false;

  void pair();
  void add_offsets(std::vector<double>& offsets) const;
  // How much earlier, in seconds, contacts have the foot leave than it does in rolling off.
  void add_early(std::vector<double>& early) const;
  Events events_with(const Offset& offset) const;

 private:
  bool stands_at(double time) const;
};

// Whether contacts have feet leave so early that they do not show the toes.
bool leave_early(const std::vector<double>& early);

}  // namespace krok::contacts
