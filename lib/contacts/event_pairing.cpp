#include "contacts/event_pairing_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "math/window.h"

namespace krok::contacts {

Seeds turning_points(const std::vector<double>& curve, double rate, double least) {
  Seeds seeds;
  if (curve.empty()) return seeds;
  std::size_t high = 0, low = 0;
  int direction = 0;
  for (std::size_t f = 0; f < curve.size(); ++f) {
    if (curve[f] > curve[high]) high = f;
    if (curve[f] < curve[low]) low = f;
    if (direction >= 0 && curve[high] - curve[f] > least) {
      if (direction > 0 || high > 0) seeds.front.push_back(static_cast<double>(high) / rate);
      direction = -1;
      low = f;
    } else if (direction <= 0 && curve[f] - curve[low] > least) {
      if (direction < 0 || low > 0) seeds.back.push_back(static_cast<double>(low) / rate);
      direction = 1;
      high = f;
    }
    if (direction > 0 && curve[f] >= curve[high]) high = f;
    if (direction < 0 && curve[f] <= curve[low]) low = f;
  }
  return seeds;
}

double cycle_of(const Seeds& seeds) {
  std::vector<double> cycles;
  for (const auto* list : {&seeds.front, &seeds.back}) {
    for (std::size_t i = 1; i < list->size(); ++i) cycles.push_back((*list)[i] - (*list)[i - 1]);
  }
  return cycles.empty() ? kUsualCycle : std::clamp(upper_median(cycles), 0.4, 2.5);
}

bool is_seeded(const Seeds& seeds, double time, double cycle) {
  double before = -1e9, after = 1e9;
  for (const auto* list : {&seeds.front, &seeds.back}) {
    for (const double seed : *list) {
      if (seed <= time) before = std::max(before, seed);
      if (seed >= time) after = std::min(after, seed);
    }
  }
  return after - before < cycle;
}

namespace {

constexpr double kAlike = 0.006;     // seconds
constexpr double kFar = 0.06;        // seconds
constexpr double kVeryFar = 0.15;    // seconds
constexpr double kScattered = 0.05;  // seconds
constexpr double kPairWithin = 0.3;  // cycles
// How long contacts may end before the toes' turning point behind the pelvis: the published
// agreement of the two is a frame at 60 Hz.
constexpr double kEarly = 0.025;     // seconds
constexpr double kVeryEarly = 0.06;  // seconds; of a single contact

// Index of the value nearest to `time`, at most `reach` away.
std::optional<std::size_t> nearest(const std::vector<double>& values, double time, double reach) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double apart = std::abs(values[i] - time);
    if (apart <= reach && (!best || apart < std::abs(values[*best] - time))) best = i;
  }
  return best;
}

}  // namespace

double Offset::weight_of(double apart) const {
  if (!known) return 1;
  if (!jittery) return std::abs(apart) > kVeryFar ? 0 : 1;
  if (std::abs(apart) > std::max(kFar, 5 * spread)) return 0;
  return std::min(1.0, kAlike * kAlike / std::max(1e-12, spread * spread));
}

Offset offset_of(std::vector<double> offsets, double usual, bool jittery) {
  Offset offset{usual};
  offset.jittery = jittery;
  if (offsets.empty()) return offset;
  offset.usual = upper_median(offsets);
  for (double& value : offsets) value = std::abs(value - offset.usual);
  offset.spread = upper_median(offsets);
  offset.scattered = offset.spread > kScattered;
  if (offset.scattered) offset.usual = usual;
  offset.known = offsets.size() >= 4;
  return offset;
}

bool Pairing::stands_at(double time) const {
  return std::ranges::any_of(
      stances, [&](const Stance& stance) { return stance.start < time && time < stance.end; });
}

void Pairing::pair() {
  event.assign(seeds->size(), std::nullopt);
  std::vector<int> taken(events.size(), -1);
  for (std::size_t i = 0; i < seeds->size(); ++i) {
    const auto found = nearest(events, (*seeds)[i], kPairWithin * cycle);
    if (!found) continue;
    const int before = taken[*found];
    if (before >= 0) {
      const double old = std::abs(events[*found] - (*seeds)[static_cast<std::size_t>(before)]);
      if (old <= std::abs(events[*found] - (*seeds)[i])) continue;
      event[static_cast<std::size_t>(before)].reset();
    }
    taken[*found] = static_cast<int>(i);
    event[i] = found;
  }
}

void Pairing::add_early(std::vector<double>& early) const {
  for (std::size_t i = 0; i < event.size(); ++i) {
    const auto off = event[i] && rolls_off ? rolls_off((*seeds)[i]) : std::nullopt;
    if (off) early.push_back(*off - events[*event[i]]);
  }
}

bool leave_early(const std::vector<double>& early) {
  return early.size() >= 2 && upper_median(early) > kEarly;
}

void Pairing::add_offsets(std::vector<double>& offsets) const {
  for (std::size_t i = 0; i < event.size(); ++i) {
    if (event[i]) offsets.push_back(events[*event[i]] - (*seeds)[i]);
  }
}

Events Pairing::events_with(const Offset& offset) const {
  Events result;
  std::vector<std::uint8_t> used(events.size(), 0);
  for (std::size_t i = 0; i < event.size(); ++i) {
    const auto off = rolls_off ? rolls_off((*seeds)[i]) : std::nullopt;
    const bool very_early = off && event[i] && *off - events[*event[i]] > kVeryEarly;
    const bool unseen = off && (toes_unseen || very_early);
    const double expected = unseen ? *off : (*seeds)[i] + offset.usual;
    if (!event[i]) {
      if (offset.scattered || stands_at(expected) || !is_low((*seeds)[i])) continue;
      result.times.push_back(expected);
      ++result.from_seeds;
      continue;
    }
    used[*event[i]] = 1;
    const double found = events[*event[i]];
    if (unseen) {
      result.times.push_back(std::max(found, expected));
      continue;
    }
    double weight = offset.weight_of(found - expected);
    // The seed is wrong if the foot still moves between prediction and event.
    if (weight == 0 && !offset.jittery && moves(found, expected)) weight = 1;
    result.times.push_back(expected + weight * (found - expected));
  }
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (!used[i] && !is_seeded(*all, events[i], cycle)) result.times.push_back(events[i]);
  }
  std::ranges::sort(result.times);
  return result;
}

}  // namespace krok::contacts
