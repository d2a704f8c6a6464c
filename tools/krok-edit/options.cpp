#include "tools/krok-edit/options.h"

#include <fmt/format.h>

#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "tools/common/option_kinds.h"
#include "tools/common/orientation_option.h"
#include "tools/common/role_input.h"

namespace krok::edit {

namespace {

void declare_cleaning(CommandOptions& command, Arguments& a) {
  const char* group = "1. Clean the whole input";
  command
      .add_flag("--spikes", a.spikes,
                "Replace frames in which a joint jumps away and back; each is reported")
      .group(group);
  add_number(command, "--spike-threshold", a.spike_threshold,
             "How many times the usual deviation from the neighbouring frames a spike reaches")
      .type_name("TIMES")
      .default_str("6")
      .group(group);
  command
      .add_option(
          "--filter", a.filter,
          "Take out jitter without a shift in time: butterworth (low-pass run both ways) or "
          "savgol (Savitzky-Golay: polynomials, keeps peaks better)")
      .type_name("KIND")
      .transform(one_of<Arguments::Filter>(
          {{"butterworth", Arguments::Filter::butterworth}, {"savgol", Arguments::Filter::savgol}}))
      .group(group);
  command
      .add_option("--cutoff", a.cutoff,
                  "butterworth: the frequency that passes with half its power")
      .type_name("FREQUENCY")
      .default_str(a.cutoff)
      .group(group);
  add_whole(command, "--window", a.window, "savgol: the frames of a polynomial, an odd number", 1,
            1000000)
      .type_name("FRAMES")
      .default_str("9")
      .group(group);
  add_whole(command, "--order", a.order,
            "butterworth: order of both passes together, 2, 4, 6 or 8 [4]; savgol: degree of "
            "the polynomials [3]",
            0, 1000000)
      .type_name("N")
      .group(group);
  command
      .add_option("--joints", a.joints,
                  "Clean only joints of this name; * stands for any characters; may be repeated")
      .type_name("PATTERN")
      .one_each_time()
      .group(group);
  command.add_option("--below", a.below, "Clean only this joint and all below it; may be repeated")
      .type_name("NAME")
      .one_each_time()
      .group(group);
}

void declare_cut(CommandOptions& command, Arguments& a) {
  const char* group = "2. Cut";
  command
      .add_option("--from", a.from,
                  "The first moment kept: 1.5s, 250ms, or 120f for a frame; a bare number is "
                  "seconds")
      .type_name("TIME")
      .group(group);
  command.add_option("--to", a.to, "The last moment kept; a frame that stands there belongs to it")
      .type_name("TIME")
      .group(group);
  command
      .add_option(
          "--sequences", a.sequences,
          "A file that names parts of the input (formats/sequences/SPEC.md). Without "
          "--sequence each becomes a file, its name put for {sequence} in the output's name")
      .type_name("IN.json")
      .group(group);
  command
      .add_option("--sequence", a.sequence,
                  "Cut out this part, at its speed, and loop it where the file says so")
      .type_name("NAME")
      .group(group);
  command
      .add_flag("--list-sequences", a.list_sequences,
                "Print the parts that the file names; nothing is written")
      .group(group);
}

void declare_timing(CommandOptions& command, Arguments& a) {
  command.add_flag("--mirror", a.mirror, "Exchange left and right, in the plane x = 0")
      .group("3. Mirror");
  const char* group = "4. Timing";
  add_number(command, "--speed", a.speed,
             "Play it so many times as fast; a sequence's own comes on top")
      .type_name("TIMES")
      .default_str("1")
      .group(group);
  add_rate(command, "--resample", a.resample, "Frames a second of the result").group(group);
}

void declare_joining(CommandOptions& command, Arguments& a) {
  const char* group = "5. Append";
  command
      .add_option("--append", a.append,
                  "Go on with this motion of the same skeleton, moved to where the figure then "
                  "stands and faces; may be repeated")
      .type_name("IN")
      .one_each_time()
      .group(group);
  command
      .add_option("--blend", a.blend,
                  "How long two motions overlap, one fading into the other; 0 is a hard cut")
      .type_name("TIME")
      .default_str(a.blend)
      .group(group);
  command
      .add_flag("--match-height", a.match_height,
                "Go on at the height where the figure then is, as on stairs")
      .group(group);
}

void declare_loop(CommandOptions& command, Arguments& a) {
  const char* group = "6. Loop";
  command
      .add_flag(
          "--loop", a.loop,
          "Let the end go over into the beginning. The last frame becomes the first one moved "
          "by the way of one round, so n frames repeat every n - 1")
      .group(group);
  command.add_option("--loop-blend", a.loop_blend, "How long before and after the seam may change")
      .type_name("TIME")
      .default_str(a.loop_blend)
      .group(group);
  add_choice<LoopEnd>(
      command, "--loop-end", a.loop_end,
      {{"auto", LoopEnd::automatic}, {"closed", LoopEnd::closed}, {"open", LoopEnd::open}},
      "Whether the last frame is the first one again (closed) or the one before it (open: a frame "
      "is added); auto compares them",
      "END", "auto")
      .group(group);
  add_choice<LoopTurn>(command, "--loop-turn", a.loop_turn,
                       {{"auto", LoopTurn::automatic},
                        {"keep", LoopTurn::keep},
                        {"straighten", LoopTurn::straighten}},
                       "Whether a round turns the figure: keep, straighten, or auto, which "
                       "straightens up to 10 degrees",
                       "TURN", "auto")
      .group(group);
  add_choice<LoopClimb>(
      command, "--loop-climb", a.loop_climb,
      {{"auto", LoopClimb::automatic}, {"keep", LoopClimb::keep}, {"level", LoopClimb::level}},
      "Whether a round gains height: keep, level, or auto, which levels up to 5 % of the figure's "
      "size",
      "CLIMB", "auto")
      .group(group);
  add_whole(command, "--rounds", a.rounds, "Write so many rounds of the loop, one after the other",
            1, 1000000)
      .type_name("N")
      .group(group);
}

void declare_place(CommandOptions& command, Arguments& a) {
  const char* travel = "7. Travel";
  command.add_flag("--in-place", a.in_place, "Take out all horizontal travel of the hips")
      .group(travel);
  command
      .add_flag("--treadmill", a.treadmill,
                "Take out only its even part, from the first frame to the last; swaying stays, and "
                "so does a loop")
      .group(travel);
  const char* size = "8. Size";
  add_number(command, "--scale", a.scale, "The whole figure and its motion, so many times as large")
      .type_name("TIMES")
      .group(size);
  command
      .add_option("--height", a.height,
                  "The same, so that the reference pose measures this from its lowest joint to its "
                  "highest: 1.8m")
      .type_name("LENGTH")
      .group(size);
  const char* place = "9. Place";
  command.add_flag("--at-origin", a.at_origin, "Begin over the origin").group(place);
  command.add_flag("--re-orient", a.re_orient, "Begin facing +Z, the same as --heading 0")
      .group(place);
  command
      .add_option("--heading", a.heading,
                  "Begin facing this way: 0 is +Z, 90deg is +X, to the figure's left")
      .type_name("ANGLE")
      .group(place);
  command
      .add_option("--turn", a.turn,
                  "Turn about the vertical through the place where it begins, to the left")
      .type_name("ANGLE")
      .group(place);
  command.add_option("--move", a.move, "Move by lengths along X, Y and Z: 1m,0,-20cm")
      .type_name("X,Y,Z")
      .group(place);
  command.add_flag("--ground", a.ground, "Bring the lowest place of the feet to y = 0")
      .group(place);
}

Error named(Error error, const char* option) {
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

Error usage(std::string message, std::string hint = {}) {
  return Error("usage", std::move(message), std::move(hint));
}

// A time that is not before the beginning.
Result<ClipTime> time_of(const std::string& text, const char* option) {
  auto time = parse_clip_time(text);
  if (!time) return named(std::move(time).error(), option);
  if (time->value < 0) return usage(fmt::format("{} {} is less than 0", option, text));
  return time;
}

Status over_nought(double value, const char* option) {
  if (value > 0 && std::isfinite(value)) return {};
  return usage(fmt::format("{} {} is not more than 0", option, readable(value)));
}

Result<Vec3> parse_move(const std::string& text) {
  Vec3 move = Vec3::Zero();
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) {
      return usage(fmt::format("--move {}: three lengths are needed, such as 1m,0,-20cm", text));
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
    // At this rate the cutoff fits; whether it fits a file's rate, the file shows.
    if (const auto known = filter::design(butterworth, 4 * *cutoff); !known) return known.error();
    options.smoothing = butterworth;
  } else if (a.filter == Filter::savgol) {
    const filter::SavitzkyGolay polynomials{a.window, a.order.value_or(3)};
    if (Status status = filter::check(polynomials); !status) return status;
    options.smoothing = polynomials;
  }
  options.joints = {a.joints, a.below};
  return {};
}

Status understand_cut(const Arguments& a, Options& options) {
  if (!a.from.empty()) {
    const auto from = time_of(a.from, "--from");
    if (!from) return from.error();
    options.from = *from;
  }
  if (!a.to.empty()) {
    const auto to = time_of(a.to, "--to");
    if (!to) return to.error();
    options.to = *to;
  }
  const bool by_name = !a.sequence.empty();
  if (by_name && (options.from || options.to)) {
    return usage("--sequence says itself where to cut; leave out --from and --to");
  }
  if ((by_name || a.list_sequences) && a.sequences.empty()) {
    return usage("the file that names the sequences is missing", "give it with --sequences");
  }
  if (!a.sequences.empty() && !by_name && (options.from || options.to)) {
    return usage("--sequences says itself where to cut; leave out --from and --to");
  }
  options.sequences = a.sequences;
  options.sequence = a.sequence;
  options.list_sequences = a.list_sequences;
  return {};
}

Status understand_loop(const Arguments& a, Options& options) {
  const auto blend = time_of(a.loop_blend, "--loop-blend");
  if (!blend) return blend.error();
  options.loop = a.loop;
  options.loop_blend = *blend;
  options.looping = {0, a.loop_end, a.loop_turn, a.loop_climb};
  options.rounds = a.rounds;
  return {};
}

Status understand_place(const Arguments& a, Options& options) {
  if (a.in_place && a.treadmill) {
    return usage("--in-place and --treadmill are two ways to take out the travel; choose one");
  }
  if (a.in_place) options.removed_travel = Travel::all;
  if (a.treadmill) options.removed_travel = Travel::trend;
  if (a.scale && !a.height.empty()) {
    return usage("--scale and --height both give the size; choose one");
  }
  if (a.scale) {
    if (Status status = over_nought(*a.scale, "--scale"); !status) return status;
  }
  options.scale = a.scale;
  if (!a.height.empty()) {
    auto height = parse_length(a.height);
    if (!height) return named(std::move(height).error(), "--height");
    if (Status status = over_nought(*height, "--height"); !status) return status;
    options.height = *height;
  }
  if (a.re_orient && !a.heading.empty()) {
    return usage("--re-orient is --heading 0; choose one of them");
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

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("input", arguments.input,
                  "The motion: a .anim file, or a capture as krok-import reads it by default")
      .type_name("IN")
      .required();
  add_map_option(command, arguments.map).group("Figure");
  declare_cleaning(command, arguments);
  declare_cut(command, arguments);
  declare_timing(command, arguments);
  declare_joining(command, arguments);
  declare_loop(command, arguments);
  declare_place(command, arguments);
  add_orientation_option(command, arguments.orientation);
  arguments.given = [&command](const char* option) { return command.count(option) > 0; };
}

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

}  // namespace krok::edit
