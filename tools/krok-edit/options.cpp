#include "tools/krok-edit/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "tools/krok-edit/event_time.h"

namespace krok::cli::edit {

namespace {

// A time, or a keytime.
Result<CutTime> parse_cut_time(const std::string& text) {
  auto event = parse_event(text);
  if (!event) return event.error();
  if (*event) return CutTime{{}, *std::move(event)};
  const auto time = clip_time().read(text);
  if (!time) return time.error();
  return CutTime{*time, {}};
}

// A person's height: metres below 10, and centimetres above, are meant where the unit is missing.
Result<double> parse_height(const std::string& text) {
  const auto bare = parse_finite(text);
  const auto height = parse_length_with_unit(text, bare && *bare < 10 ? "m" : "cm");
  return height ? length(kPositive).read(text) : height;
}

void declare_presets(CommandOptions& command, Options& o) {
  command.group("Presets");
  command
      .add_flag("--game-loop", o.game_loop,
                "A loop for a game engine: --plant --cycle auto --loop-turn straighten --treadmill "
                "--at-origin, travelling towards +Z (away from it if it walks backwards, facing it "
                "if it walks sideways or stays). The velocity that was removed is printed and "
                "stored, in the .anim and by krok-skin and krok-export in the animation's extras. "
                "Steps that are given replace these. A loop in place is kept as it is; its "
                "velocity is the speed of its feet")
      .not_with({"--sequences", "--rounds"});
}

void declare_cleaning(CommandOptions& command, Options& o) {
  const std::vector<std::string> cleaning = {"--spikes", "--filter"};
  command.group("1. Clean the whole input");
  command.add_flag(
      "--spikes", o.spikes,
      "Replace frames in which a joint jumps away and back (spikes); each is reported");
  command
      .add("--spike-threshold TIMES", o.spike_threshold, number(kPositive),
           "Spike threshold, as a multiple of the usual deviation from neighbouring frames", "6")
      .only_with("--spikes");
  command.add("--filter KIND", o.filter,
              choice<Filter>({{"auto", Filter::by_noise},
                              {"butterworth", Filter::butterworth},
                              {"savgol", Filter::savgol}}),
              "Remove jitter without time shift: auto (noise is estimated for each joint; spikes "
              "are replaced, too), butterworth (zero-phase low-pass) or savgol (Savitzky-Golay, "
              "preserves peaks better)");
  command
      .add("--cutoff", o.cutoff, frequency(), "butterworth: cutoff frequency (half power)", "6Hz")
      .only_with("--filter butterworth");
  command
      .add("--window FRAMES", o.window, whole(1, 1000000), "savgol: window size in frames, odd",
           "9")
      .only_with("--filter savgol");
  command
      .add("--filter-order", o.order, whole(0, 1000000),
           "butterworth: order of both passes together, 2, 4, 6 or 8 [4]; savgol: polynomial "
           "degree [3]")
      .only_with(std::vector<std::string>{"--filter butterworth", "--filter savgol"});
  command
      .add_option("--joints PATTERN", o.joints.patterns,
                  "Clean only joints with this name; * matches any characters; may be repeated")
      .one_each_time()
      .only_with(cleaning);
  command
      .add_option("--below NAME", o.joints.below,
                  "Clean only this joint and its descendants; may be repeated")
      .one_each_time()
      .only_with(cleaning);
  command.add_flag("--plant", o.plant,
                   "Remove foot skate: heel and ball stay where they stand, the pelvis is lowered "
                   "where a leg would be stretched");
  add_contacts_option(command, o.contacts).only_with({"--plant", "--game-loop"});
}

void declare_cut(CommandOptions& command, Options& o) {
  const ValueKind<CutTime> time = {"time", "TIME", parse_cut_time, {}};
  command.group("2. Cut");
  command.add(
      "--from", o.from, time,
      "Start of the range to keep: 1.5s, 250ms, or 120f for a frame; a bare number is seconds; or "
      "a keytime, left_strike[2] for the second of that name, from NAME.keys.json or detected as "
      "by "
      "krok-keys");
  command.add("--to", o.to, time, "End of the range to keep, inclusive");
  command
      .add("--cycle FOOT", o.cycle,
           choice<CycleFoot>({{"auto", CycleFoot::either},
                              {"left", CycleFoot::left},
                              {"right", CycleFoot::right}}),
           "Keep one gait cycle, from a strike of a foot to its next, and loop it: the one whose "
           "ends match best, of those that turn by at most 10 degrees if there are any, of either "
           "foot or of the left or right one")
      .not_with("--sequences");
  command
      .add_option("--sequences IN.json", o.sequences,
                  "File that lists sequences of the input (formats/sequences/SPEC.md). Without "
                  "--sequence each is written to a file; its name replaces {sequence} in the "
                  "output's name")
      .not_with({"--from", "--to"});
  command
      .add_option("--sequence NAME", o.sequence,
                  "Cut out this sequence, at its speed, and loop it if the file says so")
      .only_with("--sequences");
  command
      .add_flag("--list-sequences", o.list_sequences,
                "Print the sequences in the file; nothing is written")
      .only_with("--sequences");
}

void declare_timing(CommandOptions& command, Options& o) {
  command.group("3. Mirror");
  command.add_flag("--mirror", o.mirror, "Mirror left and right at the plane x = 0");
  command.group("4. Timing");
  command.add("--playback-speed TIMES", o.speed, number(kPositive),
              "Playback speed factor; multiplied by the speed of a sequence", "1");
  command.add("--rate", o.resample, rate(),
              "Frame rate of the result. Frames are interpolated: for a lower rate, --filter "
              "butterworth first removes what it cannot hold");
  command
      .add("--interpolation", o.interpolation, interpolation(),
           "Between frames: linear, or hermite with a tension (0, smooth, to 1, which stops at "
           "each frame): cubics and squad, for motions of few frames",
           "linear")
      .only_with({"--rate", "--playback-speed", "--sequences"});
}

void declare_joining(CommandOptions& command, Options& o) {
  command.group("5. Append");
  command
      .add_option("--append IN", o.append,
                  "Append this motion of the same skeleton, moved to the current position and "
                  "heading; may be repeated")
      .one_each_time();
  command
      .add("--blend", o.append_blend, clip_time(),
           "Duration of the cross-fade between two motions; 0 is a hard cut", "0.2s")
      .only_with("--append");
  command.add_flag("--match-height", o.match_height, "Append at the current height, as on stairs")
      .only_with("--append");
}

void declare_loop(CommandOptions& command, Options& o) {
  command.group("6. Loop");
  command.add_flag("--loop", o.loop,
                   "Make a seamless loop. The last frame becomes the first, moved by the root "
                   "motion of one cycle, so n frames repeat every n - 1");
  // A sequence may loop if its file says so.
  command.only_with({"--loop", "--cycle", "--game-loop", "--sequences"});
  command.add("--loop-blend", o.loop_blend, clip_time(),
              "Time before and after the seam that may change", "0.2s");
  command.add(
      "--loop-end END", o.looping.end,
      choice<LoopEnd>(
          {{"auto", LoopEnd::automatic}, {"closed", LoopEnd::closed}, {"open", LoopEnd::open}}),
      "Whether the last frame repeats the first (closed) or precedes it (open: a frame is "
      "added); auto compares them",
      "auto");
  command.add("--loop-turn TURN", o.looping.turn,
              choice<LoopTurn>({{"auto", LoopTurn::automatic},
                                {"keep", LoopTurn::keep},
                                {"straighten", LoopTurn::straighten}}),
              "Turning per cycle: keep, straighten, or auto, which straightens up to 10 degrees",
              "auto");
  command.add(
      "--loop-climb CLIMB", o.looping.climb,
      choice<LoopClimb>(
          {{"auto", LoopClimb::automatic}, {"keep", LoopClimb::keep}, {"level", LoopClimb::level}}),
      "Height gain per cycle: keep, level, or auto, which levels up to 5 % of the character's "
      "size",
      "auto");
  command.add("--rounds", o.rounds, whole(1, 1000000), "Number of cycles of the loop to write");
}

void declare_place(CommandOptions& command, Options& o) {
  command.group("7. Root motion");
  command.add_flag("--in-place", o.in_place, "Remove all horizontal motion of the hips")
      .not_with("--treadmill");
  command.add_flag("--treadmill", o.treadmill,
                   "Remove only the constant-velocity part from the first to the last frame; keeps "
                   "sway and loops");
  command.group("8. Size");
  command
      .add("--scale TIMES", o.scale, number(kPositive),
           "Scale factor for the skeleton and its motion; --height sets a stature")
      .not_with("--height");
  command.add("--height", o.height, ValueKind<double>{"length", "LENGTH", parse_height, {}},
              "Scale to this stature: 1.8m, with a unit; what is no person, to this height of the "
              "reference pose, lowest to highest joint");
  command.group("9. Position");
  command.add_flag("--at-origin", o.at_origin, "Start above the origin");
  command.add_flag("--re-orient", o.re_orient, "Start facing +Z, the same as --heading 0")
      .not_with("--heading");
  command.add("--heading", o.heading, angle(),
              "Initial heading: 0 is +Z, 90deg is +X, the character's left");
  command.add("--turn", o.turn, angle(),
              "Turn left about the vertical axis through the start position");
  command.add("--move X,Y,Z", o.move, lengths<Vec3>(), "Translate along X, Y and Z: 1m,0,-20cm");
  command.add_flag("--on-ground", o.on_ground, "Move the lowest foot position to y = 0");
  command.group("10. Ground");
  command.add_flag("--settle", o.settle,
                   "Lay the motion on --ground: hands, knees, feet and trunk that touch the level "
                   "ground of the input neither hover nor sink in, for falls, crawls and sitting. "
                   "Depth and hover are printed");
  add_ground_option(command, o.ground,
                    "Ground to settle on, as for krok-walk: a mesh, a height field, or a made one",
                    "level")
      .only_with("--settle");
  command
      .add("--floor", o.floor, length_with_unit(),
           "Height of the level ground that the input was made on [found by what lies on it]")
      .only_with("--settle");
  command
      .add_option(
          "--model IN.model", o.model,
          "Settle this mesh of the same skeleton; else bodies of usual sizes about the bones")
      .only_with("--settle");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("input IN", o.input,
                  "Motion: a .anim file, or a capture read as by krok-import without options")
      .required();
  command.group("Character");
  add_map_option(command, o.map);
  declare_presets(command, o);
  declare_cleaning(command, o);
  declare_cut(command, o);
  declare_timing(command, o);
  declare_joining(command, o);
  declare_loop(command, o);
  declare_place(command, o);
  add_orientation_option(command, o.orientation);
}

// The filter as such; at the motion's rate it is checked later.
Status check(const Options& o) {
  const auto smoothing = o.smoothing();
  if (!smoothing) return {};
  if (const auto* polynomials = std::get_if<filter::SavitzkyGolay>(&*smoothing)) {
    return filter::check(*polynomials);
  }
  const auto known = filter::design(std::get<filter::Butterworth>(*smoothing), 4 * o.cutoff);
  return known ? Status() : known.error();
}

}  // namespace

std::optional<filter::Smoothing> Options::smoothing() const {
  if (filter == Filter::none || filter == Filter::by_noise) return std::nullopt;
  if (filter == Filter::savgol) return krok::filter::SavitzkyGolay{window, order.value_or(3)};
  return krok::filter::Butterworth{cutoff, order.value_or(4)};
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-edit", options, declare, check, run);
  spec.summary = "Cleans, cuts, mirrors, retimes, joins, loops, scales and places motions";
  spec.details = "Steps run in the order listed here, regardless of the order of the options.";
  spec.inputs = "IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-edit take.anim -o clean.anim --filter auto",
       "replaces spikes and removes as much jitter as the motion is found to have"},
      {"krok-edit take.anim -o clean.anim --spikes --filter butterworth --cutoff 8Hz",
       "replaces spikes and removes jitter without time shift"},
      {"krok-edit take.anim -o walk.anim --from 1.5s --to 187f --loop --treadmill",
       "a seamless walk cycle in place"},
      {"krok-edit take.anim -o walk.anim --cycle auto --in-place",
       "the gait cycle that loops best, in place"},
      {"krok-edit takes --game-loop --keep-going --out-dir loops",
       "a loop for an engine of each take that has a cycle, with its speed"},
      {"krok-edit take.anim -o step.anim --from left_strike[1] --to left_strike[2]",
       "from the first strike of the left foot to its second"},
      {"krok-edit take.anim -o 'take_{sequence}.anim' --sequences take.json",
       "every sequence listed in a file, at its speed, looped if the file says so"},
      {"krok-edit walk.anim --plant -o planted.anim",
       "feet that stay where they stand; contacts from walk.keys.json if it exists"},
      {"krok-edit walk.anim -o both.anim --append turn.anim --blend 0.3s --at-origin --heading 0",
       "two motions in sequence, from the origin towards +Z"},
      {"krok-edit fall.anim --settle --ground stairs:rise=17cm,run=29cm -o laid.anim",
       "a fall that ends on stairs, its parts on the treads"}};
  spec.writes = registry::Kind::anim;
  spec.needs_output = false;  // --list-sequences writes nothing
  spec.batch = {io::motion_endings(), [options]() -> Result<std::string> {
                  if (options->list_sequences) {
                    return Error(
                        "usage",
                        "--list-sequences has no outputs; --out-dir and --manifest cannot be used",
                        "give a single input");
                  }
                  const bool several = !options->sequences.empty() && options->sequence.empty();
                  return std::string(several ? "_{sequence}.anim" : ".anim");
                }};
  return spec;
}

}  // namespace krok::cli::edit
