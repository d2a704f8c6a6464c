#include "tools/krok-fit/fit.h"

int main(int argc, char** argv) {
  krok::fit_tool::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-fit";
  spec.summary =
      "Makes a step library: from example motions the motion for any parameters between them, with "
      "a known error";
  spec.inputs = "LIBRARY.json";
  spec.examples = {
      {"krok-fit walking.json -o walking.steps",
       "examples as the description tells, refined until the tolerances are reached"},
      {"krok-fit walking.json -o walking.steps --refine 80 --until 0.5mm --plots charts",
       "up to 80 points, until steps are half a millimetre right, and charts of how it went"},
      {"krok-fit walking.json --resume walking.steps --refine 160 -o better.steps",
       "goes on where another run stopped"}};
  spec.exit_partly = "with --keep-going: some motions were left out, the library is made";
  spec.report_name = "--report";
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::fit_tool::declare(command, options);
  };
  spec.check = [&options] { return krok::fit_tool::check(options); };
  spec.run = [&options](krok::ToolContext& context) {
    return krok::fit_tool::run(options, context);
  };
  return krok::run_tool(spec, argc, argv);
}
