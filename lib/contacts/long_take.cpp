#include "contacts/long_take.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "contacts/sole_points.h"
#include "core/parallel.h"

namespace krok {

namespace {

constexpr double kSameEvent = 0.05;  // seconds, of one name on both sides of a border

struct Found {
  double start = 0, stop = 0;  // seconds
  MotionKeys keys;
  StepMeasures steps;
  double way = 0, duration = 0;  // that feet slid, metres; seconds
  Diagnostics warnings;
};

class Finder {
 public:
  Finder(const FrameSource& source, const RoleMap& roles, const LongTakeOptions& options)
      : source_(source),
        roles_(roles),
        part_(std::max(options.part, 1)),
        contacts_alone_(options.contacts_alone),
        margin_(static_cast<int>(
            std::min<double>(std::ceil(options.margin * source.rate), source.frame_count))) {}

  int parts() const { return std::max(1, (source_.frame_count + part_ - 1) / part_); }

  // What is in a part, with times of the whole take.
  Result<Found> find(int part) const {
    const auto [begin, end] = frames_of(part);
    const int first = std::max(0, begin - margin_);
    const int last = std::min(source_.frame_count, end + margin_);
    const auto clip = load(part_of(first, last), 1);
    if (!clip) return clip.error();
    const double from = first / source_.rate;
    Found found;
    found.start = begin / source_.rate;
    // Nothing is after the last part.
    found.stop = end == source_.frame_count ? INFINITY : end / source_.rate;
    auto contacts = find_contacts(*clip, roles_);
    if (!contacts) return contacts.error();
    Gait gait;
    if (!contacts_alone_) gait = find_gait(*clip, roles_, *contacts);
    found.warnings = std::move(contacts->warnings);
    std::ranges::move(gait.warnings, std::back_inserter(found.warnings));
    std::erase_if(gait.keytimes, [&](const Keytime& key) {
      return key.time + from < found.start || key.time + from >= found.stop;
    });
    if (!contacts_alone_) {
      found.steps = step_measures(*clip, roles_, gait.keytimes);
      found.duration = clip->duration();
      found.way = slide_speed(*clip, roles_) * found.duration;
    }
    found.keys = {std::move(contacts->contacts), std::move(gait.keytimes)};
    for (Contact& contact : found.keys.contacts) {
      contact.start += from;
      contact.end += from;
    }
    for (Keytime& key : found.keys.keytimes) key.time += from;
    return found;
  }

  // Called in the order of the parts.
  void take(int part, const Found& found) {
    for (Diagnostic warning : found.warnings) {
      if (!codes_.insert(warning.code).second) continue;
      if (parts() > 1) {
        warning.message += fmt::format(" (in the part from {:.0f} s on)", found.start);
      }
      result_.warnings.push_back(std::move(warning));
    }
    for (const Contact& contact : found.keys.contacts) take(contact, found.start, found.stop);
    for (const Keytime& key : found.keys.keytimes) take(key);
    take(found.steps);
    way_ += found.way;
    duration_ += found.duration;
    if (source_.release) source_.release(std::max(0, frames_of(part).second - margin_));
  }

  LongTake result() {
    result_.slide_speed = duration_ > 0 ? way_ / duration_ : 0;
    for (auto& [value, weight] : means_) {
      if (*value) **value /= weight;
    }
    std::ranges::sort(result_.keys.contacts, {},
                      [](const Contact& c) { return std::pair(c.start, c.joint); });
    return std::move(result_);
  }

 private:
  std::pair<int, int> frames_of(int part) const {
    const int begin = part * part_;
    return {begin, std::min(source_.frame_count, begin + part_)};
  }

  FrameSource part_of(int first, int last) const {
    FrameSource part;
    part.skeleton = source_.skeleton;
    part.rate = source_.rate;
    part.frame_count = last - first;
    part.read = [this, first](int from, int count, std::span<Vec3f> positions,
                              std::span<Quatf> orientations) {
      return source_.read(first + from, count, positions, orientations);
    };
    return part;
  }

  // One that began in an earlier part was found there, too, up to the end of its margin.
  void take(const Contact& contact, double start, double stop) {
    if (contact.end < start || contact.start >= stop) return;
    auto& all = result_.keys.contacts;
    for (auto before = all.rbegin(); before != all.rend(); ++before) {
      if (before->joint != contact.joint) continue;
      if (before->end < contact.start) break;
      before->end = std::max(before->end, contact.end);
      return;
    }
    all.push_back(contact);
  }

  void take(const Keytime& key) {
    auto& all = result_.keys.keytimes;
    for (auto before = all.rbegin(); before != all.rend(); ++before) {
      if (key.time - before->time > kSameEvent) break;
      if (before->name == key.name) return;
    }
    all.push_back(key);
  }

  void take(const StepMeasures& steps) {
    result_.steps.steps += steps.steps;
    StepMeasures& all = result_.steps;
    const std::array<const std::optional<double>*, 5> values = {
        &steps.speed, &steps.stride_length, &steps.step_length[0], &steps.step_length[1],
        &steps.step_width};
    if (means_.empty()) {
      for (std::optional<double>* value : {&all.speed, &all.stride_length, &all.step_length[0],
                                           &all.step_length[1], &all.step_width}) {
        means_.emplace_back(value, 0.0);
      }
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!*values[i]) continue;
      auto& [value, weight] = means_[i];
      *value = value->value_or(0) + steps.steps * **values[i];
      weight += steps.steps;
    }
  }

  const FrameSource& source_;
  const RoleMap& roles_;
  int part_;
  bool contacts_alone_;
  int margin_;
  LongTake result_;
  std::set<std::string> codes_;
  std::vector<std::pair<std::optional<double>*, double>> means_;  // of result_.steps, weights
  double way_ = 0, duration_ = 0;
};

}  // namespace

Result<LongTake> find_in_long_take(const FrameSource& source, const RoleMap& roles, int jobs,
                                   Progress* progress, const LongTakeOptions& options) {
  // More threads than this would take more memory than a long take is worth.
  constexpr int kThreads = 4;
  const int threads = jobs > 0 ? std::min(kThreads, jobs) : kThreads;
  Finder finder(source, roles, options);
  Progress none;
  Progress& shown = progress != nullptr ? *progress : none;
  const auto parts = static_cast<std::size_t>(finder.parts());
  std::vector<Found> found(slots_for(threads));
  shown.begin("finding steps", parts);
  const Status status = make_in_order(
      parts, threads,
      [&](std::size_t part, std::size_t slot) -> Status {
        auto made = finder.find(static_cast<int>(part));
        if (!made) return made.error();
        found[slot] = *std::move(made);
        return {};
      },
      [&](std::size_t part, std::size_t slot) {
        finder.take(static_cast<int>(part), found[slot]);
        shown.advance(1);
        return Status();
      });
  if (!status) return status.error();
  shown.end();
  return finder.result();
}

}  // namespace krok
