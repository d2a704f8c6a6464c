#include "tools/krok-edit/event_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/numbers.h"
#include "core/text.h"
#include "motion/loop.h"
#include "motion/sample.h"
#include "motion/travel.h"

namespace krok::cli::edit {

namespace {

// "left_strike (3), right_strike (2)"
std::string list_of(std::span<const Keytime> keytimes) {
  std::vector<std::pair<std::string, int>> names;
  for (const Keytime& key : keytimes) {
    const auto found = std::ranges::find(names, key.name, &std::pair<std::string, int>::first);
    if (found == names.end()) {
      names.emplace_back(key.name, 1);
    } else {
      ++found->second;
    }
  }
  std::string list;
  for (const auto& [name, count] : names) {
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", shown(name), count);
  }
  return list;
}

}  // namespace

Result<std::optional<EventTime>> parse_event(std::string_view text) {
  std::optional<EventTime> none;
  const char start = text.empty() ? '0' : text.front();
  if ((start >= '0' && start <= '9') || start == '.' || start == '-' || start == '+' ||
      start == ' ') {
    return none;
  }
  EventTime event;
  event.name = std::string(text);
  if (!text.ends_with(']')) return std::optional(event);
  const std::size_t begin = text.rfind('[');
  const auto number = begin == std::string_view::npos
                          ? std::nullopt
                          : parse_integer(text.substr(begin + 1, text.size() - begin - 2));
  if (!number || *number < 1 || *number > 1'000'000) {
    return Error("edit-event", fmt::format("{}: the number of an event is from 1", shown(text)),
                 "such as left_strike[2] for the second");
  }
  event.name = std::string(text.substr(0, begin));
  event.number = static_cast<int>(*number);
  return std::optional(event);
}

Result<double> time_of(const EventTime& event, std::span<const Keytime> keytimes) {
  int count = 0;
  for (const Keytime& key : keytimes) {
    if (key.name == event.name && ++count == event.number) return key.time;
  }
  if (count > 0) {
    return Error(
        "edit-event",
        fmt::format("{}[{}]: there are {} of that name", shown(event.name), event.number, count),
        "krok-keys prints them with their times");
  }
  std::vector<std::string> names;
  for (const Keytime& key : keytimes) names.push_back(key.name);
  const std::string near = nearest_name(event.name, names);
  return Error("edit-event", fmt::format("there is no keytime '{}'", shown(event.name)),
               keytimes.empty()
                   ? "the motion has no keytimes; krok-keys detects or sets them"
                   : fmt::format("{}available: {}",
                                 near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                                 list_of(keytimes)));
}

Result<Cycle> best_cycle(const Clip& clip, int carrier, std::span<const Keytime> keytimes,
                         CycleFoot foot, int first, int last) {
  constexpr double kWeightOfVelocity = 0.05;  // seconds
  constexpr double kOddLength = 1.4;          // times the median
  std::vector<Cycle> cycles;
  for (const char* name : {"left_strike", "right_strike"}) {
    if (foot == CycleFoot::left && name[0] != 'l') continue;
    if (foot == CycleFoot::right && name[0] != 'r') continue;
    int number = 0;
    std::optional<int> before;
    for (const Keytime& key : keytimes) {
      if (key.name != name) continue;
      ++number;
      const auto frame = static_cast<int>(std::lround(key.time * clip.rate));
      const bool inside = frame >= first && frame <= last;
      if (inside && before) cycles.push_back({*before, frame, name, number - 1, 0, 0});
      before = inside ? std::optional(frame) : std::nullopt;
    }
  }
  const auto none = [&](std::string why) {
    return Error("edit-cycle", std::move(why),
                 "krok-keys shows the strikes; or give the ends with --from, --to and --loop");
  };
  if (cycles.empty()) return none("a cycle needs two strikes of one foot");
  const auto length = [](const Cycle& cycle) { return cycle.last - cycle.first; };
  std::vector<int> lengths;
  for (const Cycle& cycle : cycles) lengths.push_back(length(cycle));
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double usual = *middle;
  std::erase_if(cycles, [&](const Cycle& cycle) {
    return length(cycle) > kOddLength * usual || length(cycle) * kOddLength < usual;
  });
  // Takes that were put together jump from one part to the next.
  std::vector<Vec3f> track;
  for (int f = first; f <= last; ++f) {
    track.push_back(clip.frame_positions(f)[static_cast<std::size_t>(carrier)]);
  }
  const std::vector<Jump> jumps = jumps_of(track, clip.rate);
  std::erase_if(cycles, [&](const Cycle& cycle) {
    return std::ranges::any_of(jumps, [&](const Jump& jump) {
      return first + jump.frame > cycle.first && first + jump.frame <= cycle.last;
    });
  });
  if (cycles.empty()) return none("the hips jump in each cycle");
  // A walk is looped along a straight way where there is one: a stride that turns has legs that
  // step aside, and its loop walks in a circle.
  std::optional<Cycle> best;
  double least = INFINITY;
  int straight = 0;
  for (Cycle& cycle : cycles) {
    const auto looped = loop(cut(clip, cycle.first, cycle.last), carrier, {.end = LoopEnd::closed});
    if (!looped) continue;
    const Seam& seam = looped->before;
    const double cost = seam.angle + kWeightOfVelocity * seam.angular_velocity;
    const bool turns = looped->turn != 0;
    straight += turns ? 0 : 1;
    const bool first_straight = !turns && straight == 1;
    if ((turns && straight > 0) || (!first_straight && !(cost < least))) continue;
    least = cost;
    cycle.angle = seam.angle;
    best = cycle;
  }
  if (!best) return none("no cycle is long enough to loop");
  best->compared = static_cast<int>(cycles.size());
  best->straight = straight;
  return *best;
}

}  // namespace krok::cli::edit
