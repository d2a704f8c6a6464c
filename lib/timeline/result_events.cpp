#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/numbers.h"
#include "core/text.h"
#include "timeline/result_keys_internal.h"

namespace krok::timeline {

namespace {

// An item of the base or of a layer, reduced to what events need.
struct Happening {
  const std::string& name;
  const std::vector<Mark>& marks;
  const Location& where;
  const PlayedRange& range;
  int layer, index;
  double start, end, first_play, last_play;
  std::function<double(double)> time_of;  // result time of a play time
};

class Events {
 public:
  Events(double rate, std::span<const Source> sources, Diagnostics& warnings)
      : rate_(rate), sources_(sources), warnings_(warnings) {}

  Status add(const Happening& item) {
    push(item, Event::Kind::begin, item.start);
    for (const Mark& mark : item.marks) {
      if (Status status = add_mark(item, mark); !status) return status;
    }
    if (item.range.round > 0) {
      for (int round = 1; round < item.range.rounds; ++round) {
        const double play = round * item.range.round;
        if (play > item.last_play - kTimeRounding) break;
        if (play < item.first_play) continue;
        push(item, Event::Kind::loop, item.time_of(play), {}, round);
      }
    }
    push(item, Event::Kind::end, item.end);
    return {};
  }

  std::vector<Event> in_order() {
    std::ranges::stable_sort(events_, {}, &Event::time);
    return std::move(events_);
  }

 private:
  void push(const Happening& item, Event::Kind kind, double time, const std::string& name = {},
            int round = 0) {
    events_.push_back({kind, time, item.name, name, item.layer, item.index, round});
  }

  Status add_mark(const Happening& item, const Mark& mark) {
    if (!mark.of_source) {
      const double time = item.start + mark.at.seconds(rate_);
      if (time >= item.start - kTimeRounding && time <= item.end + kTimeRounding) {
        push(item, Event::Kind::mark, time, mark.name);
        return {};
      }
      Error error("timeline-time",
                  fmt::format("{}: the mark '{}' at {} s is outside its {} s", shown(item.name),
                              shown(mark.name), readable(mark.at.seconds(rate_)),
                              readable(item.end - item.start)));
      error.where = item.where;
      return error;
    }
    const Source& source = sources_[static_cast<std::size_t>(item.range.source)];
    const double moment = mark.at.seconds(source.clip->rate);
    bool passed = false;
    const bool within = moment >= item.range.from && moment <= item.range.to;
    for (int round = 0; within && round < item.range.rounds; ++round) {
      const double play = item.range.play_time(round, moment);
      if (play > item.last_play + kTimeRounding) break;
      if (play < item.first_play - kTimeRounding) continue;
      push(item, Event::Kind::mark, item.time_of(play), mark.name, round);
      passed = true;
      if (!(item.range.round > 0)) break;
    }
    if (!passed) {
      Diagnostic never;
      never.severity = Severity::warning;
      never.code = "timeline-mark";
      never.message =
          fmt::format("{}: the mark '{}' at {} s of {} is never reached", shown(item.name),
                      shown(mark.name), readable(moment), shown(source.name));
      never.where = item.where;
      warnings_.push_back(std::move(never));
    }
    return {};
  }

  double rate_;
  std::span<const Source> sources_;
  Diagnostics& warnings_;
  std::vector<Event> events_;
};

// Number of rounds that start before a play time.
int rounds_until(const PlayedRange& range, double play_time) {
  return range.at(play_time - kTimeRounding).round + 1;
}

}  // namespace

Result<std::vector<Event>> result_events(const Parts& parts, Diagnostics& warnings) {
  Events events(parts.clip.rate, parts.sources, warnings);
  for (std::size_t i = 0; i < parts.base.items().size(); ++i) {
    const ScheduledItem& item = parts.base.items()[i];
    const BaseItem& entry = parts.timeline.base[i];
    const Status status =
        events.add({entry.name, entry.marks, entry.where, item.range, -1, static_cast<int>(i),
                    item.start, item.end, item.skipped, item.play_time(item.end),
                    [&](double play) { return item.time_of(play); }});
    if (!status) return status.error();
  }
  for (std::size_t l = 0; l < parts.layers.size(); ++l) {
    for (std::size_t i = 0; i < parts.layers[l].items().size(); ++i) {
      const LayerTimes& times = parts.layers[l].items()[i];
      const LayerItem& entry = parts.timeline.layers[l].items[i];
      const Status status =
          events.add({entry.name, entry.marks, entry.where, times.range, static_cast<int>(l),
                      static_cast<int>(i), times.start, times.end, 0, times.end - times.start,
                      [&](double play) { return times.start + play; }});
      if (!status) return status.error();
    }
  }
  return events.in_order();
}

std::vector<ItemFacts> result_items(const Parts& parts) {
  std::vector<ItemFacts> facts;
  for (std::size_t i = 0; i < parts.base.items().size(); ++i) {
    const ScheduledItem& item = parts.base.items()[i];
    facts.push_back({parts.timeline.base[i].name, -1, item.start, item.end,
                     rounds_until(item.range, item.play_time(item.end)), item.skipped});
  }
  for (std::size_t l = 0; l < parts.layers.size(); ++l) {
    for (std::size_t i = 0; i < parts.layers[l].items().size(); ++i) {
      const LayerTimes& times = parts.layers[l].items()[i];
      facts.push_back({parts.timeline.layers[l].items[i].name, static_cast<int>(l), times.start,
                       times.end, rounds_until(times.range, times.end - times.start), 0});
    }
  }
  return facts;
}

}  // namespace krok::timeline
