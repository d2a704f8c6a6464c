#include "timeline/played_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::timeline {

namespace {

constexpr double kFrameRounding = 1e-3;  // tolerance for times outside a motion, frames
constexpr double kMinSpeed = 1e-3, kMaxSpeed = 1e3;
constexpr double kSameKey = 0.05;  // seconds within which keytimes at a seam are the same

Result<double> moment_of(const ClipTime& time, const Source& source, std::string_view which) {
  const Clip& clip = *source.clip;
  const double seconds = time.seconds(clip.rate), last = clip.duration();
  const double beyond = kFrameRounding / clip.rate;
  if (std::isfinite(seconds) && seconds >= -beyond && seconds <= last + beyond) {
    return std::clamp(seconds, 0.0, last);
  }
  // A frame number without its unit.
  const bool frame = !time.in_frames && time.value > last && time.value == std::floor(time.value) &&
                     time.value < clip.frame_count();
  return Error(
      "timeline-time",
      fmt::format("plays {} {} s, outside 0 to {} s ({}) of {}", which, readable(seconds),
                  readable(last), counted(clip.frame_count(), "frame"), shown(source.name)),
      frame ? fmt::format("a bare number is seconds; \"{}f\" is a frame", time.value) : "");
}

Result<const Part*> part_of(const Play& play, const Source& source) {
  for (const Part& part : source.parts) {
    if (part.name == play.part) return &part;
  }
  std::string known;
  for (std::size_t i = 0; i < std::min<std::size_t>(source.parts.size(), 10); ++i) {
    known += (i == 0 ? "" : ", ") + shown(source.parts[i].name);
  }
  return Error("timeline-source",
               fmt::format("{} has no sequence '{}'", shown(source.name), shown(play.part)),
               known.empty() ? "" : "known sequences: " + known);
}

}  // namespace

double PlayedRange::duration() const {
  return round > 0 ? rounds * round : HUGE_VAL;
}

PlayedRange::Moment PlayedRange::at(double play_time) const {
  if (!(round > 0)) return {0, from};
  const double into = std::clamp(play_time, 0.0, duration());
  int number = static_cast<int>(std::min(std::floor(into / round), kMaxRounds + 1.0));
  // Within rounding of a seam: snap to the seam.
  if ((number + 1) * round - into < 1e-9 * round) ++number;
  if (number >= rounds) number = static_cast<int>(rounds) - 1;
  const double part = std::clamp(into - number * round, 0.0, round) * speed;
  const double time = speed > 0 ? from + part : to + part;
  return {number, std::clamp(time, from, to)};
}

double PlayedRange::play_time(int number, double source_time) const {
  return number * round + (source_time - (speed > 0 ? from : to)) / speed;
}

Result<PlayedRange> resolve(const Play& play, std::span<const Source> sources) {
  if (play.source < 0 || play.source >= static_cast<int>(sources.size())) {
    return Error("timeline-source", "the source does not exist");
  }
  const Source& source = sources[static_cast<std::size_t>(play.source)];
  PlayedRange range;
  range.source = play.source;
  ClipTime from, to{source.clip->duration(), false};
  if (!play.part.empty()) {
    const auto part = part_of(play, source);
    if (!part) return part.error();
    from = (*part)->from;
    to = (*part)->to;
    range.speed = (*part)->speed;
    range.loops_if_ended = (*part)->loop && !play.rounds;
  }
  const auto begin = moment_of(play.from.value_or(from), source, "from");
  if (!begin) return begin.error();
  const auto end = moment_of(play.to.value_or(to), source, "to");
  if (!end) return end.error();
  if (*end < *begin) {
    return Error(
        "timeline-time",
        fmt::format("plays to {} s, before its start at {} s", readable(*end), readable(*begin)),
        "use a negative speed to play backwards");
  }
  range.from = *begin;
  range.to = *end;
  range.speed = play.speed.value_or(range.speed);
  if (!(std::abs(range.speed) >= kMinSpeed && std::abs(range.speed) <= kMaxSpeed)) {
    return Error("timeline-time",
                 fmt::format("the speed {} is not between 0.001 and 1000, forwards or backwards",
                             readable(range.speed)));
  }
  range.round = (range.to - range.from) / std::abs(range.speed);
  const int rounds = play.rounds.value_or(1);
  if (rounds < 0 || rounds > kMaxRounds) {
    return Error("timeline-limit",
                 fmt::format("{} rounds: not between 0 and {}", rounds, grouped(kMaxRounds)));
  }
  range.rounds = rounds == 0 ? HUGE_VAL : rounds;
  return range;
}

std::vector<PlayedKey> played_keys(const PlayedRange& range, const MotionKeys& keys, double low,
                                   double high, std::size_t most) {
  std::vector<PlayedKey> found;
  if (range.speed < 0) return found;
  const bool once = range.rounds <= 1 || !(range.round > 0);
  std::vector<const Keytime*> of_a_round;
  for (const Keytime& key : keys.keytimes) {
    if (once || (key.time >= range.from && key.time <= range.to)) of_a_round.push_back(&key);
  }
  if (of_a_round.empty()) return found;
  const auto round_at = [&](double time) {
    return static_cast<int>(std::clamp(std::floor(time / range.round), 0.0,
                                       std::min(range.rounds - 1, double(kMaxRounds))));
  };
  const int first = once ? 0 : round_at(low), last = once ? 0 : round_at(high);
  for (int round = first; round <= last; ++round) {
    for (const Keytime* key : of_a_round) {
      const double time = range.play_time(round, key->time);
      if (time < low || time > high) continue;
      const bool repeated = !found.empty() && (found.back().key->name == key->name
                                                   ? time - found.back().play_time < kSameKey
                                                   : time <= found.back().play_time);
      if (repeated) continue;
      found.push_back({time, key});
      if (found.size() > most) return found;
    }
  }
  return found;
}

}  // namespace krok::timeline
