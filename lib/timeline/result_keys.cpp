#include "timeline/result_keys_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <functional>

#include "core/numbers.h"
#include "core/text.h"

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
      Diagnostic never = make_warning(
          "timeline-mark",
          fmt::format("{}: the mark '{}' at {} s of {} is never reached", shown(item.name),
                      shown(mark.name), readable(moment), shown(source.name)));
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

namespace {

constexpr double kApart = 1e-4;      // seconds between keytimes
constexpr double kSamePlace = 0.02;  // metres, for contacts that continue through a loop seam

struct Span {
  double begin, end;
};

class KeyFinder {
 public:
  explicit KeyFinder(const Parts& parts)
      : parts_(parts), items_(parts.base.items()), frame_(1 / parts.clip.rate) {}

  MotionKeys find() {
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const Source& source = parts_.base.player(i).source();
      if (source.keys == nullptr) continue;
      add_keytimes(i, *source.keys);
      add_contacts(i, *source.keys);
    }
    finish_keytimes();
    merge_contacts();
    leave_out_layers();
    std::ranges::sort(keys_.contacts, [](const Contact& a, const Contact& b) {
      return a.start != b.start ? a.start < b.start : a.joint < b.joint;
    });
    return std::move(keys_);
  }

 private:
  // Whether an item provides the keytimes at a time.
  bool counts(std::size_t i, double time) const {
    const ScheduledItem& item = items_[i];
    if (time < item.start || time > item.end) return false;
    const auto over = [&](std::size_t k) {
      const ScheduledItem& next = items_[k];
      const Change& change = parts_.timeline.base[k].change;
      if (change.kind != ChangeKind::crossfade) return time >= next.begin ? 1.0 : 0.0;
      if (time >= next.settled) return 1.0;
      return change.easing.at((time - next.begin) / (next.settled - next.begin));
    };
    if (i > 0 && over(i) < 0.5) return false;
    return i + 1 == items_.size() || over(i + 1) < 0.5;
  }

  int rounds_of(std::size_t i) const {
    return items_[i].range.at(items_[i].play_time(items_[i].end)).round + 1;
  }

  void add_keytimes(std::size_t i, const MotionKeys& keys) {
    const ScheduledItem& item = items_[i];
    if (!(item.range.round > 0)) return;
    for (const PlayedKey& key :
         played_keys(item.range, keys, 0, item.play_time(item.end) + frame_, SIZE_MAX)) {
      if (key.key->time < item.range.from || key.key->time > item.range.to) continue;
      const double time = item.time_of(key.play_time);
      if (counts(i, time)) keys_.keytimes.push_back({time, key.key->name});
    }
  }

  void finish_keytimes() {
    std::ranges::stable_sort(keys_.keytimes, {}, &Keytime::time);
    std::vector<Keytime> kept;
    const double last = parts_.clip.duration();
    for (Keytime& key : keys_.keytimes) {
      if (key.time > last + frame_) continue;
      key.time = std::min(key.time, last);
      if (kept.empty() || key.time - kept.back().time > kApart) kept.push_back(std::move(key));
    }
    keys_.keytimes = std::move(kept);
  }

  // When only this item is active.
  Span alone(std::size_t i) const {
    const double end = i + 1 < items_.size() ? items_[i + 1].begin : items_[i].end;
    return {items_[i].settled, std::min(end, parts_.clip.duration())};
  }

  void add_contacts(std::size_t i, const MotionKeys& keys) {
    const ScheduledItem& item = items_[i];
    const Span seen = alone(i);
    const PlayedRange& range = item.range;
    for (int round = 0; round < rounds_of(i); ++round) {
      const Transform placed = parts_.base.player(i).round_place(round).to_world();
      for (const Contact& contact : keys.contacts) {
        const double from = std::max(contact.start, range.from);
        const double to = std::min(contact.end, range.to);
        if (from > to) continue;
        Span stay = seen;  // in a held pose the contact lasts throughout
        if (range.round > 0) {
          const double a = item.time_of(range.play_time(round, from));
          const double b = item.time_of(range.play_time(round, to));
          stay = {std::max(std::min(a, b), seen.begin), std::min(std::max(a, b), seen.end)};
        }
        if (stay.end - stay.begin < frame_) continue;
        keys_.contacts.push_back({contact.joint, stay.begin, stay.end, placed * contact.place});
      }
    }
  }

  // Joins contacts that continue from the end of one round into the next.
  void merge_contacts() {
    std::ranges::stable_sort(keys_.contacts, [](const Contact& a, const Contact& b) {
      return a.joint != b.joint ? a.joint < b.joint : a.start < b.start;
    });
    std::vector<Contact> merged;
    for (const Contact& contact : keys_.contacts) {
      if (!merged.empty() && merged.back().joint == contact.joint &&
          contact.start - merged.back().end < 1.5 * frame_ &&
          (contact.place - merged.back().place).norm() < kSamePlace) {
        merged.back().end = std::max(merged.back().end, contact.end);
      } else {
        merged.push_back(contact);
      }
    }
    keys_.contacts = std::move(merged);
  }

  void leave_out_layers() {
    for (const LayerPlayer& layer : parts_.layers) {
      for (const LayerTimes& times : layer.items()) {
        std::vector<Contact> left;
        for (const Contact& contact : keys_.contacts) {
          const bool moved = layer.touched()[static_cast<std::size_t>(contact.joint)] != 0;
          if (!moved || contact.end < times.start || contact.start > times.end) {
            left.push_back(contact);
            continue;
          }
          for (const Span part : {Span{contact.start, times.start}, Span{times.end, contact.end}}) {
            if (part.end - part.begin < frame_) continue;
            left.push_back({contact.joint, part.begin, part.end, contact.place});
          }
        }
        keys_.contacts = std::move(left);
      }
    }
  }

  const Parts& parts_;
  const std::vector<ScheduledItem>& items_;
  double frame_;
  MotionKeys keys_;
};

}  // namespace

MotionKeys result_keys(const Parts& parts) {
  return KeyFinder(parts).find();
}

}  // namespace krok::timeline
