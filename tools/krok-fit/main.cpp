#include "tools/krok-fit/fit.h"

int main(int argc, char** argv) {
  krok::fit_tool::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-fit";
  spec.summary =
      "Fits a step library to example motions, so that krok-synth can make motions for any "
      "parameters between them, with a measured error";
  spec.inputs = "LIBRARY.json";
  spec.examples = {
      {"krok-fit walking.json -o walking.steps",
       "uses the examples in the description and refines until the tolerances are met"},
      {"krok-fit walking.json -o walking.steps --refine 80 --until 0.5mm --plots charts",
       "inserts up to 80 points until lengths are within 0.5 mm, and writes charts"},
      {"krok-fit walking.json --resume walking.steps --refine 160 -o better.steps",
       "continues the refinement of an earlier run"}};
  spec.exit_partly = "with --keep-going: some motions were left out, the library was written";
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
