#include "contacts/contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "contacts/series_internal.h"
#include "math/window.h"

namespace krok {

namespace {

constexpr double kUsualLeg = 0.86;     // metres
constexpr double kSamePlace = 0.15;    // metres
constexpr double kJitterSpeed = 0.06;  // metres per second
constexpr double kJitterTimes = 2;
constexpr double kLowestCutoff = 5;     // Hz
constexpr double kRefineWindow = 0.12;  // seconds
constexpr double kEndWindow = 0.2;      // seconds
constexpr double kOffGround = 0.006;    // metres
constexpr double kNotDown = 0.012;      // metres; heels give way as they take load
constexpr double kOffJitter = 3;        // deviations of jitter

// A run of frames in which a point is still; edges in fractional frames.
struct Run {
  int track = 0;
  double first = 0, last = 0;
  bool open_start = false, open_end = false;
  Vec3 place = Vec3::Zero();

  bool overlaps(const Run& other) const { return first < other.last && other.first < last; }
};

struct Tracks {
  double rate = 30;
  std::vector<std::vector<Vec3>> raw, smooth;
  std::vector<double> deviation;  // of the jitter, metres
  std::vector<double> jitter;     // metres per second, left after smoothing
};

// The fractional frame between f - 1 and f at which a value crosses `threshold`.
double crossing(double before, double after, double threshold, int f) {
  const double rise = after - before;
  if (rise == 0) return f;
  return f - 1 + std::clamp((threshold - before) / rise, 0.0, 1.0);
}

// Runs of low values with hysteresis: on at or below `on`, off above `off`. The edges are the
// crossings of these thresholds.
std::vector<Run> low_runs(const std::vector<double>& values, double on, double off) {
  std::vector<Run> runs;
  bool within = false;
  for (int f = 0; f < static_cast<int>(values.size()); ++f) {
    const double now = values[static_cast<std::size_t>(f)];
    const double before = f > 0 ? values[static_cast<std::size_t>(f - 1)] : now;
    if (!within && now <= on) {
      within = true;
      Run run;
      run.open_start = f == 0;
      run.first = f == 0 ? 0 : crossing(before, now, on, f);
      runs.push_back(run);
    } else if (within && now > off) {
      within = false;
      runs.back().last = crossing(before, now, off, f);
    }
  }
  if (within) {
    runs.back().last = static_cast<double>(values.size()) - 1;
    runs.back().open_end = true;
  }
  return runs;
}

Vec3 middle_place(const std::vector<Vec3>& track, double first, double last) {
  std::vector<Vec3> places;
  const int from = static_cast<int>(std::ceil(first)), to = static_cast<int>(std::floor(last));
  for (int f = std::min(from, to); f <= std::max(from, to); ++f) {
    const auto place =
        static_cast<std::size_t>(std::clamp(f, 0, static_cast<int>(track.size()) - 1));
    places.push_back(track[place]);
  }
  return median_place(places);
}

// Cuts a run to its longest part within the thresholds of the run's own level.
void cut_to_level(const std::vector<Vec3>& track, double on, double off, Run& run) {
  const int from = static_cast<int>(std::ceil(run.first)),
            to = static_cast<int>(std::floor(run.last));
  std::vector<double> heights;
  for (int f = from; f <= to; ++f) {
    heights.push_back(std::abs(track[static_cast<std::size_t>(f)].y() - run.place.y()));
  }
  if (heights.empty()) return;
  const std::vector<Run> level = low_runs(heights, on, off);
  const auto longest =
      std::ranges::max_element(level, {}, [](const Run& part) { return part.last - part.first; });
  if (longest == level.end()) return;
  if (!longest->open_start) run.first = from + longest->first, run.open_start = false;
  if (!longest->open_end) run.last = from + longest->last, run.open_end = false;
}

class ContactFinder {
 public:
  ContactFinder(const Clip& clip, const ContactOptions& options, FoundContacts& found)
      : clip_(clip), options_(options), found_(found), scale_(found.leg_length / kUsualLeg) {}

  void find() {
    take_tracks();
    for (std::size_t t = 0; t < found_.tracks.size(); ++t) find_runs(static_cast<int>(t));
    leave_out_air();
    for (Run& run : runs_) {
      if (options_.refine) cut_at_ends(run);
      refine(run);
    }
    set_heights();
    for (const Run& run : runs_) {
      found_.stays.push_back({run.track, run.first / clip_.rate, run.last / clip_.rate,
                              run.open_start, run.open_end, run.place});
    }
    std::ranges::sort(found_.stays, {}, [](const Stay& s) { return std::tuple(s.track, s.start); });
  }

 private:
  void take_tracks() {
    tracks_.rate = clip_.rate;
    for (PointTrack& track : found_.tracks) {
      tracks_.raw.push_back(track_of(clip_, track.point, found_.leg_length));
      const double jitter = contacts::jitter_of(tracks_.raw.back());
      const double wanted = contacts::cutoff_for(jitter, kJitterSpeed * scale_, clip_.rate);
      const double cutoff =
          std::clamp(wanted, std::min(kLowestCutoff, options_.cutoff), options_.cutoff);
      tracks_.smooth.push_back(contacts::smoothed(tracks_.raw.back(), clip_.rate, cutoff));
      tracks_.deviation.push_back(jitter);
      tracks_.jitter.push_back(contacts::speed_jitter(jitter, cutoff, clip_.rate));
      track.speed = contacts::norms(contacts::velocities(tracks_.smooth.back(), clip_.rate));
    }
  }

  const std::vector<Vec3>& smooth(const Run& run) const {
    return tracks_.smooth[static_cast<std::size_t>(run.track)];
  }

  void find_runs(int track) {
    const double jitter = kJitterTimes * tracks_.jitter[static_cast<std::size_t>(track)];
    std::vector<Run> runs = low_runs(found_.tracks[static_cast<std::size_t>(track)].speed,
                                     std::hypot(options_.on_speed * scale_, jitter),
                                     std::hypot(options_.off_speed * scale_, jitter));
    std::vector<Run> kept;
    for (Run& run : runs) {
      run.track = track;
      run.place = middle_place(smooth(run), run.first, run.last);
      cut_to_level(smooth(run), options_.on_height * scale_, options_.off_height * scale_, run);
      const bool again = !kept.empty() &&
                         run.first - kept.back().last < 0.5 * options_.shortest * clip_.rate &&
                         (run.place - kept.back().place).norm() < options_.on_height * scale_;
      if (again) {
        kept.back().last = run.last;
        kept.back().open_end = run.open_end;
        kept.back().place = middle_place(smooth(run), kept.back().first, run.last);
      } else {
        kept.push_back(run);
      }
    }
    // Runs cut off by the clip's ends may have been longer.
    std::erase_if(kept, [&](const Run& run) {
      if (run.open_start || run.open_end) return false;
      return run.last - run.first < options_.shortest * clip_.rate;
    });
    runs_.insert(runs_.end(), kept.begin(), kept.end());
  }

  const SolePoint& point(const Run& run) const {
    return found_.tracks[static_cast<std::size_t>(run.track)].point;
  }

  // Runs by the square of ground that they are on, the lowest first.
  using Square = std::pair<long, long>;
  Square square_of(const Run& run) const {
    const double side = kSamePlace * scale_;
    return {std::lround(run.place.x() / side), std::lround(run.place.z() / side)};
  }
  std::map<Square, std::vector<const Run*>> by_square() const {
    std::map<Square, std::vector<const Run*>> squares;
    for (const Run& run : runs_) squares[square_of(run)].push_back(&run);
    for (auto& [square, runs] : squares) {
      std::ranges::stable_sort(runs, {}, [](const Run* run) { return run->place.y(); });
    }
    return squares;
  }

  // Whether the same part of a foot stood clearly lower in this place.
  bool floor_is_lower(const Run& run,
                      const std::map<Square, std::vector<const Run*>>& squares) const {
    const Square here = square_of(run);
    for (const long x : {-1L, 0L, 1L}) {
      for (const long z : {-1L, 0L, 1L}) {
        const auto square = squares.find({here.first + x, here.second + z});
        if (square == squares.end()) continue;
        for (const Run* other : square->second) {
          const Vec3 apart = other->place - run.place;
          if (!(-apart.y() > options_.off_height * scale_)) break;
          if (point(*other).part == point(run).part &&
              Vec2(apart.x(), apart.z()).norm() < kSamePlace * scale_) {
            return true;
          }
        }
      }
    }
    return false;
  }

  // Whether the other foot stands lower all the while: this one then never bears the character.
  // Runs are by track, then in the order of time.
  bool other_foot_bears(const Run& run) const {
    std::vector<const Run*> lower;
    for (auto track = runs_.begin(); track != runs_.end();) {
      const auto end = std::upper_bound(track, runs_.end(), track->track,
                                        [](int t, const Run& other) { return t < other.track; });
      auto other = std::lower_bound(track, end, run.first,
                                    [](const Run& r, double first) { return r.last < first; });
      for (; other != end && other->first <= run.last; ++other) {
        if (point(*other).side != point(run).side &&
            run.place.y() - other->place.y() >
                options_.off_height * scale_ + rise_of(run, *other)) {
          lower.push_back(&*other);
        }
      }
      track = end;
    }
    for (double f = std::ceil(run.first); f <= run.last; ++f) {
      const bool borne = std::ranges::any_of(
          lower, [&](const Run* other) { return other->first <= f && f <= other->last; });
      if (!borne) return false;
    }
    return true;
  }
  // The height of one part of a flat foot above another: 0 for points of the sole, but a ball joint
  // is inside the foot.
  double rise_of(const Run& run, const Run& other) const {
    return point(run).part == point(other).part ? 0 : 0.03 * scale_;
  }

  void leave_out_air() {
    std::vector<Run> kept;
    const auto squares = by_square();
    for (const Run& run : runs_) {
      if (!floor_is_lower(run, squares) && !other_foot_bears(run)) kept.push_back(run);
    }
    runs_ = std::move(kept);
  }

  // A point that comes down or leaves just beside the clip's ends is not fast enough there to be
  // off by its speed. It is off where it is higher than the rest of its run.
  void cut_at_ends(Run& run) const {
    const auto& raw = tracks_.raw[static_cast<std::size_t>(run.track)];
    const double level =
        run.place.y() + kOffJitter * tracks_.deviation[static_cast<std::size_t>(run.track)];
    const double window = kEndWindow * clip_.rate;
    const int first = static_cast<int>(std::ceil(run.first)),
              last = static_cast<int>(std::floor(run.last));
    const auto is_above = [&](double height, int f) {
      return raw[static_cast<std::size_t>(f)].y() > level + height * scale_;
    };
    int from = first, to = last;
    if (run.open_start) {
      while (from < to && from - first < window && is_above(kNotDown, from)) ++from;
    }
    if (run.open_end) {
      while (to > from && last - to < window && is_above(kOffGround, to)) --to;
    }
    if (from > first) run.first = from, run.open_start = false;
    if (to < last) run.last = to, run.open_end = false;
  }

  void refine(Run& run) const {
    if (!options_.refine || run.last - run.first < 2) return;
    const auto& raw = tracks_.raw[static_cast<std::size_t>(run.track)];
    const double window = std::max(kRefineWindow * clip_.rate, 4.0);
    double first = run.first, last = run.last;
    if (!run.open_start) first = contacts::break_near(raw, run.first, window, true);
    if (!run.open_end) last = contacts::break_near(raw, run.last, window, false);
    if (last > first) run.first = first, run.last = last;
  }

  // The support height at a frame: the level of the contact there, interpolated between contacts.
  void set_heights() {
    for (std::size_t t = 0; t < found_.tracks.size(); ++t) {
      PointTrack& track = found_.tracks[t];
      const auto& smooth = tracks_.smooth[t];
      std::vector<const Run*> own;
      for (const Run& run : runs_) {
        if (run.track == static_cast<int>(t)) own.push_back(&run);
      }
      double lowest = 0;
      for (std::size_t f = 0; f < smooth.size(); ++f) {
        lowest = f == 0 ? smooth[f].y() : std::min(lowest, smooth[f].y());
      }
      std::size_t next = 0;
      for (std::size_t f = 0; f < smooth.size(); ++f) {
        const auto frame = static_cast<double>(f);
        while (next < own.size() && own[next]->last < frame) ++next;
        double level = lowest;
        if (next < own.size() && (next == 0 || own[next]->first <= frame)) {
          level = own[next]->place.y();
        } else if (next == own.size() && next > 0) {
          level = own[next - 1]->place.y();
        } else if (next > 0) {
          const Run &from = *own[next - 1], &to = *own[next];
          const double part = (frame - from.last) / std::max(1e-9, to.first - from.last);
          level = from.place.y() * (1 - part) + to.place.y() * part;
        }
        track.height.push_back(smooth[f].y() - level);
      }
    }
  }

  const Clip& clip_;
  const ContactOptions& options_;
  FoundContacts& found_;
  double scale_;
  Tracks tracks_;
  std::vector<Run> runs_;
};

// Contacts of joints, from the stays of their points.
void take_contacts(const Clip& clip, FoundContacts& found) {
  std::vector<Vec3> track;
  int of_track = -1;
  for (const Stay& stay : found.stays) {
    const SolePoint& point = found.tracks[static_cast<std::size_t>(stay.track)].point;
    if (point.estimated && point.part != FootPart::heel) continue;
    // A touch at the clip's very end is an instant, not a contact.
    if ((stay.end - stay.start) * clip.rate < 1) continue;
    // Stays are by track.
    if (stay.track != of_track) {
      of_track = stay.track;
      SolePoint joint = point;
      joint.offset = Vec3::Zero();
      track = track_of(clip, joint, found.leg_length);
    }
    const Vec3 place = middle_place(track, stay.start * clip.rate, stay.end * clip.rate);
    found.contacts.push_back({point.joint, stay.start, stay.end, place});
  }
  std::ranges::sort(found.contacts, {},
                    [](const Contact& c) { return std::tuple(c.start, c.joint); });
}

}  // namespace

Result<FoundContacts> find_contacts(const Clip& clip, const RoleMap& roles,
                                    const ContactOptions& options) {
  const Feet feet = find_feet(clip, roles);
  FoundContacts found;
  found.leg_length = feet.leg_length;
  for (const auto& points : feet.points) {
    for (const SolePoint& point : points) found.tracks.push_back({point, {}, {}});
  }
  if (found.tracks.empty()) {
    return Error("contacts-feet", "no foot joint was found in the skeleton",
                 "assign the joints of legs and feet with a role map");
  }
  if (clip.frame_count() < 3) {
    found.warnings.push_back(make_warning(
        "contacts-short",
        fmt::format("{} frames are too few to detect contacts", clip.frame_count()), ""));
    return found;
  }
  ContactFinder(clip, options, found).find();
  take_contacts(clip, found);
  if (found.contacts.empty()) {
    found.warnings.push_back(make_warning(
        "contacts-none", "no foot contact was found",
        "the feet never rest: in place, as on a treadmill, floating, or sliding as in some runs"));
  }
  return found;
}

int middle_frame(const Contact& contact, double rate, int frames) {
  const double middle = 0.5 * (contact.start + contact.end) * rate;
  return static_cast<int>(std::clamp<double>(std::lround(middle), 0, frames - 1));
}

void place_contacts(const Clip& clip, std::span<Contact> contacts) {
  if (clip.frame_count() == 0) return;
  for (Contact& contact : contacts) {
    const auto places = clip.frame_positions(middle_frame(contact, clip.rate, clip.frame_count()));
    contact.place = places[static_cast<std::size_t>(contact.joint)].cast<double>();
  }
}

}  // namespace krok
