#include "tools/krok-edit/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-edit/run.h"
#include "tools/shared/orientation_option.h"
#include "tools/shared/planting.h"
#include "tools/shared/role_input.h"

namespace krok::cli::edit {

namespace {

void declare_cleaning(CommandOptions& command, Arguments& a) {
  command.group("1. Clean the whole input");
  command.add_flag(
      "--spikes", a.spikes,
      "Replace frames in which a joint jumps away and back (spikes); each is reported");
  add_number(command, "--spike-threshold TIMES", a.spike_threshold,
             "Spike threshold, as a multiple of the usual deviation from neighbouring frames")
      .default_str("6");
  command
      .add_option("--filter KIND", a.filter,
                  "Remove jitter without time shift: butterworth (zero-phase low-pass) or savgol "
                  "(Savitzky-Golay, preserves peaks better)")
      .transform(one_of<Arguments::Filter>({{"butterworth", Arguments::Filter::butterworth},
                                            {"savgol", Arguments::Filter::savgol}}));
  command.add_option("--cutoff FREQUENCY", a.cutoff, "butterworth: cutoff frequency (half power)")
      .default_str(a.cutoff);
  add_whole(command, "--window FRAMES", a.window, "savgol: window size in frames, odd", 1, 1000000)
      .default_str("9");
  add_whole(
      command, "--order N", a.order,
      "butterworth: order of both passes together, 2, 4, 6 or 8 [4]; savgol: polynomial degree [3]",
      0, 1000000);
  command
      .add_option("--joints PATTERN", a.joints,
                  "Clean only joints with this name; * matches any characters; may be repeated")
      .one_each_time();
  command
      .add_option("--below NAME", a.below,
                  "Clean only this joint and its descendants; may be repeated")
      .one_each_time();
  command.add_flag("--plant", a.plant,
                   "Remove foot skate: heel and ball stay where they stand, the pelvis is lowered "
                   "where a leg would be stretched");
  add_contacts_option(command, a.contacts);
}

void declare_cut(CommandOptions& command, Arguments& a) {
  command.group("2. Cut");
  command.add_option(
      "--from TIME", a.from,
      "Start of the range to keep: 1.5s, 250ms, or 120f for a frame; a bare number is seconds; or "
      "a keytime, left_strike[2] for the second of that name, from NAME.keys.json or detected as "
      "by "
      "krok-keys");
  command.add_option("--to TIME", a.to, "End of the range to keep, inclusive");
  add_choice(
      command, "--cycle", a.cycle,
      {{"auto", CycleFoot::either}, {"left", CycleFoot::left}, {"right", CycleFoot::right}},
      "Keep one gait cycle, from a strike of a foot to its next, and loop it: the one whose "
      "ends match best, of those that turn by at most 10 degrees if there are any, of either "
      "foot or of the left or right one",
      "FOOT", "");
  command.add_option(
      "--sequences IN.json", a.sequences,
      "File that lists sequences of the input (formats/sequences/SPEC.md). Without --sequence each "
      "is written to a file; its name replaces {sequence} in the output's name");
  command.add_option("--sequence NAME", a.sequence,
                     "Cut out this sequence, at its speed, and loop it if the file says so");
  command.add_flag("--list-sequences", a.list_sequences,
                   "Print the sequences in the file; nothing is written");
}

void declare_timing(CommandOptions& command, Arguments& a) {
  command.group("3. Mirror");
  command.add_flag("--mirror", a.mirror, "Mirror left and right at the plane x = 0");
  command.group("4. Timing");
  add_number(command, "--speed TIMES", a.speed,
             "Playback speed factor; multiplied by the speed of a sequence")
      .default_str("1");
  add_rate(
      command, "--resample", a.resample,
      "Frame rate of the result. Frames are interpolated: for a lower rate, --filter butterworth "
      "first removes what it cannot hold");
}

void declare_joining(CommandOptions& command, Arguments& a) {
  command.group("5. Append");
  command
      .add_option("--append IN", a.append,
                  "Append this motion of the same skeleton, moved to the current position and "
                  "heading; may be repeated")
      .one_each_time();
  command
      .add_option("--blend TIME", a.blend,
                  "Duration of the cross-fade between two motions; 0 is a hard cut")
      .default_str(a.blend);
  command.add_flag("--match-height", a.match_height, "Append at the current height, as on stairs");
}

void declare_loop(CommandOptions& command, Arguments& a) {
  command.group("6. Loop");
  command.add_flag("--loop", a.loop,
                   "Make a seamless loop. The last frame becomes the first, moved by the root "
                   "motion of one cycle, so n frames repeat every n - 1");
  command
      .add_option("--loop-blend TIME", a.loop_blend,
                  "Time before and after the seam that may change")
      .default_str(a.loop_blend);
  add_choice<LoopEnd>(
      command, "--loop-end", a.loop_end,
      {{"auto", LoopEnd::automatic}, {"closed", LoopEnd::closed}, {"open", LoopEnd::open}},
      "Whether the last frame repeats the first (closed) or precedes it (open: a frame is added); "
      "auto compares them",
      "END", "auto");
  add_choice<LoopTurn>(
      command, "--loop-turn", a.loop_turn,
      {{"auto", LoopTurn::automatic},
       {"keep", LoopTurn::keep},
       {"straighten", LoopTurn::straighten}},
      "Turning per cycle: keep, straighten, or auto, which straightens up to 10 degrees", "TURN",
      "auto");
  add_choice<LoopClimb>(
      command, "--loop-climb", a.loop_climb,
      {{"auto", LoopClimb::automatic}, {"keep", LoopClimb::keep}, {"level", LoopClimb::level}},
      "Height gain per cycle: keep, level, or auto, which levels up to 5 % of the character's size",
      "CLIMB", "auto");
  add_whole(command, "--rounds N", a.rounds, "Number of cycles of the loop to write", 1, 1000000);
}

void declare_place(CommandOptions& command, Arguments& a) {
  command.group("7. Root motion");
  command.add_flag("--in-place", a.in_place, "Remove all horizontal motion of the hips");
  command.add_flag("--treadmill", a.treadmill,
                   "Remove only the constant-velocity part from the first to the last frame; keeps "
                   "sway and loops");
  command.group("8. Size");
  add_number(command, "--scale TIMES", a.scale, "Scale factor for the skeleton and its motion");
  command.add_option(
      "--height LENGTH", a.height,
      "Scale to this height of the reference pose, lowest to highest joint: 1.8m, with a unit");
  command.group("9. Position");
  command.add_flag("--at-origin", a.at_origin, "Start above the origin");
  command.add_flag("--re-orient", a.re_orient, "Start facing +Z, the same as --heading 0");
  command.add_option("--heading ANGLE", a.heading,
                     "Initial heading: 0 is +Z, 90deg is +X, the character's left");
  command.add_option("--turn ANGLE", a.turn,
                     "Turn left about the vertical axis through the start position");
  command.add_option("--move X,Y,Z", a.move, "Translate along X, Y and Z: 1m,0,-20cm");
  command.add_flag("--ground", a.ground, "Move the lowest foot position to y = 0");
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("input IN", arguments.input,
                  "Motion: a .anim file, or a capture read as by krok-import without options")
      .required();
  command.group("Character");
  add_map_option(command, arguments.map);
  declare_cleaning(command, arguments);
  declare_cut(command, arguments);
  declare_timing(command, arguments);
  declare_joining(command, arguments);
  declare_loop(command, arguments);
  declare_place(command, arguments);
  add_orientation_option(command, arguments.orientation);
  arguments.given = [&command](const char* option) { return command.count(option) > 0; };
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-edit", arguments, declare, understand, run);
  spec.summary = "Cleans, cuts, mirrors, retimes, joins, loops, scales and places motions";
  spec.details = "Steps run in the order listed here, regardless of the order of the options.";
  spec.inputs = "IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-edit take.anim -o clean.anim --spikes --filter butterworth --cutoff 8Hz",
       "replaces spikes and removes jitter without time shift"},
      {"krok-edit take.anim -o walk.anim --from 1.5s --to 187f --loop --treadmill",
       "a seamless walk cycle in place"},
      {"krok-edit take.anim -o walk.anim --cycle auto --in-place",
       "the gait cycle that loops best, in place"},
      {"krok-edit take.anim -o step.anim --from left_strike[1] --to left_strike[2]",
       "from the first strike of the left foot to its second"},
      {"krok-edit take.anim -o 'take_{sequence}.anim' --sequences take.json",
       "every sequence listed in a file, at its speed, looped if the file says so"},
      {"krok-edit walk.anim --plant -o planted.anim",
       "feet that stay where they stand; contacts from walk.keys.json if it exists"},
      {"krok-edit walk.anim -o both.anim --append turn.anim --blend 0.3s --at-origin --heading 0",
       "two motions in sequence, from the origin towards +Z"}};
  spec.needs_output = false;  // --list-sequences writes nothing
  spec.batch = {io::motion_endings(), [arguments]() -> Result<std::string> {
                  if (arguments->list_sequences) {
                    return Error(
                        "usage",
                        "--list-sequences has no outputs; --out-dir and --manifest cannot be used",
                        "give a single input");
                  }
                  const bool several = !arguments->sequences.empty() && arguments->sequence.empty();
                  return std::string(several ? "_{sequence}.anim" : ".anim");
                }};
  return spec;
}

}  // namespace krok::cli::edit
