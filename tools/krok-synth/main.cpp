#include "tools/cli/tool.h"
#include "tools/krok-synth/options.h"

int main(int argc, char** argv) {
  krok::synth_tool::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-synth";
  spec.summary = "Makes a motion with given parameters from a step library";
  spec.inputs = "IN.steps";
  spec.examples = {{"krok-synth walking.steps --set length=70cm --set turn=15deg -o step.anim",
                    "one step of that length and turn; prints its measured parameters"},
                   {"krok-synth walking.steps --set length=0.7 --correct --side right -o step.anim",
                    "a step of the right foot, corrected to within a hundredth of the tolerance"},
                   {"krok-synth walking.steps --table points.csv -o steps/step.anim",
                    "one motion per row of a table with a column per parameter: step_1.anim, ..."}};
  spec.exit_no = "with --strict: a motion differs from what was asked by more than the tolerance";
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::synth_tool::declare(command, options);
  };
  spec.check = [&options] { return krok::synth_tool::check(options); };
  spec.run = [&options](krok::ToolContext& context) {
    return krok::synth_tool::run(options, context);
  };
  return krok::run_tool(spec, argc, argv);
}
