#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "tools/cli/usage.h"
#include "tools/krok-edit/event_time.h"
#include "tools/krok-edit/options.h"

namespace krok::cli::edit {

namespace {

constexpr double kTallest = 10;  // metres; bare heights above are centimetres

Error named(Error error, const char* option) {
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

// A time that is not negative.
Result<ClipTime> time_of(const std::string& text, const char* option) {
  auto time = parse_clip_time(text);
  if (!time) return named(std::move(time).error(), option);
  if (time->value < 0) return usage(fmt::format("{} {} is less than 0", option, text));
  return time;
}

Status over_nought(double value, const char* option) {
  if (value > 0 && std::isfinite(value)) return {};
  return usage(fmt::format("{} {} is not greater than 0", option, readable(value)));
}

Result<Vec3> parse_move(const std::string& text) {
  Vec3 move = Vec3::Zero();
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) {
      return usage(fmt::format("--move {}: expected three lengths, such as 1m,0,-20cm", text));
    }
    auto length = parse_length(trimmed(std::string_view(text).substr(begin, end - begin)));
    if (!length) return named(std::move(length).error(), "--move");
    move[axis] = *length;
    begin = end + 1;
  }
  return move;
}

Status understand_cleaning(const Arguments& a, Options& options) {
  using Filter = Arguments::Filter;
  if (a.spikes) {
    if (Status status = over_nought(a.spike_threshold, "--spike-threshold"); !status) return status;
    options.spike_threshold = a.spike_threshold;
  }
  if (a.filter == Filter::butterworth) {
    auto cutoff = parse_frequency(a.cutoff);
    if (!cutoff) return named(std::move(cutoff).error(), "--cutoff");
    if (Status status = over_nought(*cutoff, "--cutoff"); !status) return status;
    const filter::Butterworth butterworth{*cutoff, a.order.value_or(4)};
    // The cutoff is valid at this rate; the file's own rate is checked later.
    if (const auto known = filter::design(butterworth, 4 * *cutoff); !known) return known.error();
    options.smoothing = butterworth;
  } else if (a.filter == Filter::savgol) {
    const filter::SavitzkyGolay polynomials{a.window, a.order.value_or(3)};
    if (Status status = filter::check(polynomials); !status) return status;
    options.smoothing = polynomials;
  }
  options.joints = {a.joints, a.below};
  options.plant = a.plant;
  options.contacts = a.contacts;
  return {};
}

// A time or a keytime.
Status understand_end(const std::string& text, const char* option, std::optional<ClipTime>& time,
                      std::optional<EventTime>& event) {
  if (text.empty()) return {};
  auto named_event = parse_event(text);
  if (!named_event) return named(std::move(named_event).error(), option);
  event = *std::move(named_event);
  if (event) return {};
  const auto given = time_of(text, option);
  if (!given) return given.error();
  time = *given;
  return {};
}

Status understand_cut(const Arguments& a, Options& options) {
  if (Status status = understand_end(a.from, "--from", options.from, options.from_event); !status) {
    return status;
  }
  if (Status status = understand_end(a.to, "--to", options.to, options.to_event); !status) {
    return status;
  }
  options.cycle = a.cycle;
  const bool cut = !a.from.empty() || !a.to.empty();
  if (a.cycle != CycleFoot::none && !a.sequences.empty()) {
    return usage("--cycle and --sequences exclude each other");
  }
  const bool by_name = !a.sequence.empty();
  if (by_name && cut) {
    return usage("--sequence cannot be combined with --from and --to");
  }
  if ((by_name || a.list_sequences) && a.sequences.empty()) {
    return usage("no sequences file given", "add --sequences FILE");
  }
  if (!a.sequences.empty() && !by_name && cut) {
    return usage("--sequences cannot be combined with --from and --to");
  }
  options.sequences = a.sequences;
  options.sequence = a.sequence;
  options.list_sequences = a.list_sequences;
  return {};
}

Status understand_loop(const Arguments& a, Options& options) {
  const auto blend = time_of(a.loop_blend, "--loop-blend");
  if (!blend) return blend.error();
  options.loop = a.loop || a.cycle != CycleFoot::none;
  options.loop_blend = *blend;
  options.looping = {0, a.loop_end, a.loop_turn, a.loop_climb};
  options.rounds = a.rounds;
  return {};
}

Status understand_place(const Arguments& a, Options& options) {
  if (a.in_place && a.treadmill) {
    return usage("--in-place and --treadmill exclude each other");
  }
  if (a.in_place) options.removed_travel = Travel::all;
  if (a.treadmill) options.removed_travel = Travel::trend;
  if (a.scale && !a.height.empty()) {
    return usage("--scale and --height exclude each other");
  }
  if (a.scale) {
    if (Status status = over_nought(*a.scale, "--scale"); !status) return status;
  }
  options.scale = a.scale;
  if (!a.height.empty()) {
    const auto bare = parse_finite(a.height);
    auto height = parse_length_with_unit(a.height, bare && *bare < kTallest ? "m" : "cm");
    if (!height) return named(std::move(height).error(), "--height");
    if (Status status = over_nought(*height, "--height"); !status) return status;
    options.height = *height;
  }
  if (a.re_orient && !a.heading.empty()) {
    return usage("--re-orient and --heading exclude each other");
  }
  if (a.re_orient) options.heading = 0;
  if (!a.heading.empty()) {
    auto heading = parse_angle(a.heading);
    if (!heading) return named(std::move(heading).error(), "--heading");
    options.heading = *heading;
  }
  if (!a.turn.empty()) {
    auto turn = parse_angle(a.turn);
    if (!turn) return named(std::move(turn).error(), "--turn");
    options.turn = *turn;
  }
  if (!a.move.empty()) {
    const auto move = parse_move(a.move);
    if (!move) return move.error();
    options.move = *move;
  }
  options.at_origin = a.at_origin;
  options.ground = a.ground;
  return {};
}

}  // namespace

Result<Options> understand(const Arguments& arguments) {
  if (Status status = check_needs(arguments); !status) return status.error();
  Options options;
  options.input = arguments.input;
  options.map = arguments.map;
  options.orientation = arguments.orientation;
  options.mirror = arguments.mirror;
  options.speed = arguments.speed;
  options.resample = arguments.resample;
  options.append = arguments.append;
  options.match_height = arguments.match_height;
  if (Status status = over_nought(arguments.speed, "--speed"); !status) return status.error();
  const auto blend = time_of(arguments.blend, "--blend");
  if (!blend) return blend.error();
  options.append_blend = *blend;
  for (const auto understand_some :
       {understand_cleaning, understand_cut, understand_loop, understand_place}) {
    if (Status status = understand_some(arguments, options); !status) {
      return status.error();
    }
  }
  return options;
}

}  // namespace krok::cli::edit
