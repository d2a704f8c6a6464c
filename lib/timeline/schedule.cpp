#include "timeline/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "timeline/in_step.h"

namespace krok::timeline {

namespace {

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

}  // namespace krok::timeline
