#include <algorithm>
#include <cmath>
#include <cstdint>

#include "timeline/result_keys_internal.h"

namespace krok::timeline {

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
