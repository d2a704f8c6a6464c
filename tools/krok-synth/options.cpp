#include "tools/krok-synth/options.h"

#include <memory>

#include "tools/shared/shared_options.h"

namespace krok::cli::synth {

namespace {

void declare(CommandOptions& command, Options& options) {
  command.add_option("library IN.steps", options.library, "Step library made by krok-fit")
      .required();
  command.group("Parameters");
  command
      .add_option("--set NAME=VALUE", options.set,
                  "Value of a parameter: length=70cm, turn=15deg, duration=0.6s")
      .not_with("--points");
  command.add_option("--points IN.csv", options.table,
                     "Table (CSV) with a column per parameter; makes one motion per row, named as "
                     "-o plus the row number");
  command.add_flag("--extrapolate", options.extrapolate,
                   "Allow parameters outside the range of the examples, and weights outside -0.25 "
                   "to 1.25, where the error is unknown");
  command.add_flag("--strict", options.strict,
                   "Exit with 1 if a motion differs from what was asked by more than the library's "
                   "tolerance (otherwise a warning)");
  command.group("Motion");
  command.add("--side SIDE", options.side,
              choice<SideChoice>({{"library", SideChoice::library},
                                  {"left", SideChoice::left},
                                  {"right", SideChoice::right}}),
              "Swing foot: library (as in the library), left or right", "library");
  command.add_flag("--correct", options.correct,
                   "Correct the weights until the measured parameters match");
  add_plant_flag(command, options.plant);
  command.add("--rate", options.rate, rate(),
              "Frames per second (default: the library's, adjusted so that the duration is exact)");
  add_orientation_option(command, options.orientation);
  command.group("Sequence");
  command.add_option(
      "--after IN", options.after,
      "Continue this motion of the same skeleton, such as a walk: the new one begins "
      "where and as it ends, on the level");
  command
      .add_flag("--in-sequence", options.in_sequence,
                "One motion of all rows of --points, each where and as the one before ends")
      .only_with("--points");
  command
      .add("--transition", options.transition, seconds(),
           "Time in which what differs between two motions decays", "0.4s")
      .only_with({"--after", "--in-sequence"});
  command
      .add("--place X,Y,Z", options.place, lengths<Vec3>(),
           "Bring the joint that the library measures across, up and along to this place in the "
           "world, where --after has led: -0.4m,1.2m,3m")
      .only_with("--after")
      .not_with({"--set", "--points", "--rate"});
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-synth", options, declare, nullptr, run);
  spec.exit_no = "with --strict: a motion differs from what was asked by more than the tolerance";
  spec.summary = "Makes motions for given parameters from a step library";
  spec.inputs = "IN.steps";
  spec.writes = registry::Kind::anim;
  spec.examples = {
      {"krok-synth reaching.steps --after walk.anim --place 0.3m,1.2m,4.1m -o both.anim",
       "a walk, then the hand reaches for a place in the world"},
      {"krok-synth walking.steps --set length=70cm --set turn=15deg -o step.anim",
       "one step of that length and turn; prints its measured parameters"},
      {"krok-synth walking.steps --set length=0.7 --correct --side right -o step.anim",
       "a step of the right foot, corrected to within a hundredth of the tolerance"},
      {"krok-synth walking.steps --points points.csv -o steps/step.anim",
       "one motion per row of a table with a column per parameter: step_1.anim, ..."}};
  return spec;
}

}  // namespace krok::cli::synth
