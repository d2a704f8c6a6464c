#include "timeline/schedule.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "blend/time_map.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::timeline {

namespace {

// Time alignment of two motions during a crossfade.
struct InStep {
  double skipped = 0;                  // play time at which the next motion starts
  std::vector<double> previous, next;  // play times, evenly spaced over the crossfade
};

struct StepSide {
  const PlayedRange& range;
  const MotionKeys* keys;  // may be null
};

constexpr double kLongestStep = 10;  // max seconds between matched keytimes
constexpr int kParts = 256;          // per crossfade
constexpr std::size_t kMaxKeys = 4000;

struct Pairs {
  std::vector<double> previous, next;  // play times of the shared keytimes
  std::size_t begin = 0;               // the crossfade begins after this one
};

// The shared keytimes around keytime `p` of the previous motion and `n` of the next.
Pairs pairs_around(const std::vector<PlayedKey>& previous, std::size_t p,
                   const std::vector<PlayedKey>& next, std::size_t n) {
  Pairs pairs;
  const auto same = [&](std::size_t a, std::size_t b) {
    return previous[a].key->name == next[b].key->name;
  };
  std::size_t back = 0;
  while (back < 2 && back < p && back < n && same(p - back - 1, n - back - 1)) ++back;
  pairs.begin = back;
  for (std::size_t k = 0; p - back + k < previous.size() && n - back + k < next.size() &&
                          same(p - back + k, n - back + k);
       ++k) {
    pairs.previous.push_back(previous[p - back + k].play_time);
    pairs.next.push_back(next[n - back + k].play_time);
  }
  return pairs;
}

double generic_at(const blend::TimeMap& map, double low, double time) {
  double high = low + 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (map.at(middle) < time ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

InStep integrate(const Pairs& pairs, double previous_play, double duration, const Easing& easing) {
  const blend::TimeMap a(pairs.previous, blend::Warp::pchip), b(pairs.next, blend::Warp::pchip);
  double generic = generic_at(a, static_cast<double>(pairs.begin), previous_play);
  InStep result;
  result.skipped = b.at(generic);
  result.previous.push_back(previous_play);
  result.next.push_back(result.skipped);
  const double step = duration / kParts;
  // Generic time per second; the slope of a monotone cubic may be 0 at a keytime.
  const auto speed = [&](double at, double part) {
    const double weight = std::clamp(easing.at(part / kParts), 0.0, 1.0);
    return 1 / std::max((1 - weight) * a.slope(at) + weight * b.slope(at), 1e-3);
  };
  for (int i = 0; i < kParts; ++i) {
    if (generic < a.last()) {
      const double half = generic + 0.5 * step * speed(generic, i);
      const double moved = std::min(generic + step * speed(half, i + 0.5), a.last());
      const double went = moved - generic;
      generic = moved;
      if (went > 0 && generic < a.last()) {
        result.previous.push_back(a.at(generic));
        result.next.push_back(b.at(generic));
        continue;
      }
    }
    result.previous.push_back(result.previous.back() + step);
    result.next.push_back(result.next.back() + step);
  }
  return result;
}

std::optional<InStep> align(const std::vector<PlayedKey>& before,
                            const std::vector<PlayedKey>& after, double previous_play,
                            double duration, const Easing& easing) {
  if (before.size() < 2 || after.size() < 2) return std::nullopt;
  // The last keytime with another after it: a motion that ends with a step is still within it.
  std::size_t p = 0;
  while (p + 2 < before.size() && before[p + 1].play_time <= previous_play) ++p;
  if (before[p].play_time > previous_play || before[p + 1].play_time < previous_play) {
    return std::nullopt;
  }
  for (std::size_t n = 0; n + 1 < after.size(); ++n) {
    if (before[p].key->name != after[n].key->name ||
        before[p + 1].key->name != after[n + 1].key->name) {
      continue;
    }
    const InStep found =
        integrate(pairs_around(before, p, after, n), previous_play, duration, easing);
    if (found.skipped >= -1e-9) return found;
  }
  return std::nullopt;
}

std::vector<PlayedKey> strikes_of(std::vector<PlayedKey> keys) {
  std::erase_if(keys, [](const PlayedKey& key) { return !key.key->name.ends_with("_strike"); });
  return keys;
}

// `previous_play` is the play time of the previous motion at the start of the crossfade. The next
// motion starts at its first moment that has the same generic time between two keytimes of the same
// names; between two strikes ("left_strike") where the other keytimes come in another order, as
// those of a walk and a run do. During the crossfade an interval of generic time lasts the weighted
// sum of its durations in both motions, as in lib/blend; after the last matching keytime both
// motions play at their own speed. Returns nullopt if no such moment exists.
std::optional<InStep> play_in_step(const StepSide& previous, const StepSide& next,
                                   double previous_play, double duration, const Easing& easing) {
  if (previous.keys == nullptr || next.keys == nullptr) return std::nullopt;
  const auto before = played_keys(previous.range, *previous.keys, previous_play - kLongestStep,
                                  previous_play + 4 * duration + kLongestStep, kMaxKeys);
  const double most = std::min(next.range.duration(), 60.0);
  const auto after =
      played_keys(next.range, *next.keys, -kLongestStep, most + 4 * duration, kMaxKeys);
  if (before.size() > kMaxKeys || after.size() > kMaxKeys) return std::nullopt;
  auto found = align(before, after, previous_play, duration, easing);
  // In a run the foot leaves before the other one strikes, in a walk after it: only the strikes
  // come in the same order.
  if (!found) {
    found = align(strikes_of(before), strikes_of(after), previous_play, duration, easing);
  }
  return found;
}

constexpr double kLongest = 1e7;  // seconds; mix() limits the number of frames

class Scheduler {
 public:
  Scheduler(const Timeline& timeline, std::span<const Source> sources, double rate)
      : timeline_(timeline), sources_(sources), rate_(rate) {}

  Result<std::vector<ScheduledItem>> run() {
    if (timeline_.base.empty()) return Error("timeline-empty", "the timeline is empty");
    for (std::size_t i = 0; i < timeline_.base.size(); ++i) {
      if (Status status = add(i); !status) return located(std::move(status).error(), i);
    }
    ScheduledItem& last = items_.back();
    const auto end = natural_end(items_.size() - 1, false);
    if (!end) return located(end.error(), items_.size() - 1);
    if (!std::isfinite(*end)) {
      return located(Error("timeline-endless", "never ends", "add \"until\" or a number of rounds"),
                     items_.size() - 1);
    }
    last.end = *end;
    if (Status status = check_length(items_.size() - 1); !status) {
      return located(status.error(), items_.size() - 1);
    }
    return std::move(items_);
  }

 private:
  Error located(Error error, std::size_t i) const {
    error.where = timeline_.base[i].where;
    error.message = fmt::format("{}: {}", shown(timeline_.base[i].name), error.message);
    return error;
  }

  // When an item ends if nothing follows. `followed`: the next item has an explicit start time.
  Result<double> natural_end(std::size_t i, bool followed) {
    ScheduledItem& item = items_[i];
    const BaseItem& entry = timeline_.base[i];
    if (item.range.loops_if_ended && (followed || entry.play.until)) item.range.rounds = HUGE_VAL;
    const double lasts = item.range.duration();
    const double end = std::isfinite(lasts) ? item.time_of(lasts) : HUGE_VAL;
    if (!entry.play.until) return end;
    const double until = entry.play.until->seconds(rate_);
    if (!std::isfinite(until) || until > kLongest || until < item.start - kTimeRounding) {
      return Error("timeline-time", fmt::format("ends at {} s, before it starts at {} s",
                                                readable(until), readable(item.start)));
    }
    if (until > end + kTimeRounding) {
      return Error(
          "timeline-time",
          fmt::format("plays to {} s only, but \"until\" is {} s", readable(end), readable(until)),
          "set \"loop\": true to repeat it until then");
    }
    return until;
  }

  Status check_change(const Change& change) const {
    if (change.kind == ChangeKind::cut) return {};
    if (change.duration > 0 && change.duration <= kLongest) return {};
    return Error("timeline-time", "the duration of a change must be positive");
  }

  Status check_length(std::size_t i) const {
    const ScheduledItem& item = items_[i];
    if (item.end < item.settled - kTimeRounding) {
      return Error("timeline-time",
                   fmt::format("ends at {} s, before the change into it ends at {} s",
                               readable(item.end), readable(item.settled)),
                   "shorten the change, or play the item longer");
    }
    if (item.range.round > 0 && (item.end - item.start) / item.range.round > kMaxRounds) {
      return Error("timeline-limit",
                   fmt::format("repeats more than {} times", grouped(kMaxRounds)));
    }
    return {};
  }

  Status add(std::size_t i) {
    const BaseItem& entry = timeline_.base[i];
    auto range = resolve(entry.play, sources_);
    if (!range) return range.error();
    ScheduledItem item;
    item.range = *range;
    if (i == 0) {
      if (entry.at && entry.at->seconds(rate_) != 0) {
        return Error("timeline-time", "the first item must start at 0");
      }
    } else {
      if (Status status = check_change(entry.change); !status) return status;
      if (Status status = follow(i, item); !status) return status;
    }
    items_.push_back(std::move(item));
    return {};
  }

  // Ends the previous item and starts this one.
  Status follow(std::size_t i, ScheduledItem& item) {
    const BaseItem& entry = timeline_.base[i];
    const Change& change = entry.change;
    ScheduledItem& before = items_[i - 1];
    const auto end = natural_end(i - 1, entry.at.has_value());
    if (!end) return end.error();
    const bool fades = change.kind == ChangeKind::crossfade;
    if (!entry.at && !std::isfinite(*end)) {
      return Error("timeline-endless",
                   fmt::format("{} never ends, so this item never starts",
                               shown(timeline_.base[i - 1].name)),
                   "add \"at\", or \"until\" or a number of rounds to the previous item");
    }
    item.begin = entry.at ? entry.at->seconds(rate_) : *end - (fades ? change.duration : 0);
    if (!std::isfinite(item.begin) || item.begin > kLongest) {
      return Error("timeline-time", "the start time is not valid");
    }
    if (fades && !entry.at && item.begin < before.settled - kTimeRounding) {
      return Error(
          "timeline-time",
          fmt::format("the crossfade takes {} s, but {} plays for {} s", readable(change.duration),
                      shown(timeline_.base[i - 1].name), readable(*end - before.settled, 4)),
          "shorten the crossfade, or loop the item before it");
    }
    if (item.begin < before.settled - kTimeRounding) {
      return Error("timeline-time",
                   fmt::format("starts at {} s, before the change into {} ends at {} s",
                               readable(item.begin), shown(timeline_.base[i - 1].name),
                               readable(before.settled)),
                   "changes must not overlap");
    }
    item.begin = std::max(item.begin, before.settled);
    const double needed = item.begin + (fades ? change.duration : 0);
    if (needed > *end + kTimeRounding) {
      return Error("timeline-time",
                   fmt::format("{} ends at {} s, but is needed until {} s",
                               shown(timeline_.base[i - 1].name), readable(*end), readable(needed)),
                   "play it longer or loop it, or start the next item earlier");
    }
    item.settled = item.begin + (change.kind == ChangeKind::cut ? 0 : change.duration);
    item.start = change.kind == ChangeKind::smooth ? item.settled : item.begin;
    before.end = needed;
    if (fades) {
      if (Status status = keep_in_step(entry, before, item); !status) return status;
    }
    return check_length(i - 1);
  }

  Status keep_in_step(const BaseItem& entry, ScheduledItem& before, ScheduledItem& item) const {
    const Change& change = entry.change;
    if (change.sync == Sync::clock) return {};
    const auto keys = [&](const ScheduledItem& of) {
      return sources_[static_cast<std::size_t>(of.range.source)].keys;
    };
    const double begins_at = before.play_time(item.begin);
    auto both = play_in_step({before.range, keys(before)}, {item.range, keys(item)}, begins_at,
                             change.duration, change.easing);
    if (!both || !(both->next.back() < item.range.duration())) {
      if (change.sync == Sync::automatic) {
        const auto has_keys = [&](const ScheduledItem& of) {
          const MotionKeys* found = keys(of);
          return found != nullptr && found->keytimes.size() > 1;
        };
        item.has_other_keys = has_keys(before) && has_keys(item);
        item.lacks_keys = !item.has_other_keys;
        return {};
      }
      return Error("timeline-sync",
                   both ? "with time alignment it would end before the change into it"
                        : "has no keytimes with the same names and order as those of the previous "
                          "motion where the change begins",
                   "show or set keytimes with krok-keys, or use \"sync\": \"clock\"");
    }
    item.in_step = true;
    item.skipped = both->skipped;
    before.out = {item.begin, item.settled, std::move(both->previous)};
    item.in = {item.begin, item.settled, std::move(both->next)};
    return {};
  }

  const Timeline& timeline_;
  std::span<const Source> sources_;
  double rate_;
  std::vector<ScheduledItem> items_;
};

}  // namespace

double TimeWarp::at(double time) const {
  const double last = static_cast<double>(play_times.size() - 1);
  const double place = std::clamp((time - begin) / (end - begin) * last, 0.0, last);
  const auto i = std::min(static_cast<std::size_t>(place), play_times.size() - 2);
  return play_times[i] + (place - static_cast<double>(i)) * (play_times[i + 1] - play_times[i]);
}

double ScheduledItem::play_time(double time) const {
  if (in.holds(time)) return in.at(time);
  if (out.holds(time)) return out.at(time);
  if (in.play_times.empty()) return skipped + (time - start);
  return in.play_times.back() + (time - in.end);
}

double ScheduledItem::time_of(double play) const {
  const auto inverse = [play](const TimeWarp& warp) {
    const auto after = std::ranges::upper_bound(warp.play_times, play);
    const auto i = std::clamp<std::ptrdiff_t>(after - warp.play_times.begin() - 1, 0,
                                              std::ssize(warp.play_times) - 2);
    const auto k = static_cast<std::size_t>(i);
    const double low = warp.play_times[k], high = warp.play_times[k + 1];
    const double part = static_cast<double>(i) + (high > low ? (play - low) / (high - low) : 0);
    return warp.begin +
           part * (warp.end - warp.begin) / static_cast<double>(warp.play_times.size() - 1);
  };
  if (!in.play_times.empty() && play <= in.play_times.back()) return inverse(in);
  if (!out.play_times.empty() && play >= out.play_times.front()) return inverse(out);
  if (in.play_times.empty()) return start + (play - skipped);
  return in.end + (play - in.play_times.back());
}

Result<std::vector<ScheduledItem>> schedule(const Timeline& timeline,
                                            std::span<const Source> sources, double rate) {
  return Scheduler(timeline, sources, rate).run();
}

std::string_view change_name(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::cut:
      return "cut";
    case ChangeKind::crossfade:
      return "crossfade";
    case ChangeKind::smooth:
      return "smooth";
    case ChangeKind::inertial:
      return "inertial";
  }
  return "change";
}

}  // namespace krok::timeline
