#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "contacts/gait_seeds_internal.h"

// What contacts show of a foot's strikes, or of its offs, held against the seeds.

namespace krok::contacts {

inline constexpr double kOffAfterBack = 0.01;  // seconds, where nothing shows it
inline constexpr double kStrikeAfterFront = 0.03;

// What the pairs of seeds and events of one kind have in common, over both feet.
struct Offset {
  double usual, spread = 0;  // seconds, median and median deviation
  bool known = false;
  bool jittery = false;

  // How much what the contacts show counts beside what the seeds let expect: all of it where they
  // agree as well as people's steps are alike or the capture is clean, little where jitter scatters
  // it, nothing where it lies far off.
  double weight_of(double apart) const;
};

// `usual` is for where there are no offsets to tell it.
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
  // Whether a foot without a point for its toes leaves the ground at the seed; may be empty.
  std::function<bool(double seed)> leaves_unseen;

  void pair();
  void add_offsets(std::vector<double>& offsets) const;
  Events events_with(const Offset& offset) const;

 private:
  bool stands_at(double time) const;
};

}  // namespace krok::contacts
