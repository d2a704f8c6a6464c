#include "tools/krok-blend/blend_files.h"

int main(int argc, char** argv) {
  krok::blend_tool::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-blend";
  spec.summary = "Blends motions: a weighted sum, time-aligned by keytimes";
  spec.inputs = "IN.anim:WEIGHT...";
  spec.examples = {
      {"krok-blend slow.anim:0.3 fast.anim:0.7 -o brisk.anim", "a blend of two walks"},
      {"krok-blend walk.anim:@out.csv run.anim:@in.csv -o start.anim --save-warp warp.csv",
       "a transition from walk to run, with weight curves over generic time (columns generic, "
       "weight)"},
      {"krok-blend a.anim:0.5 b.anim:0.5 -o c.anim --warp dtw",
       "motions without keytimes, aligned by the similarity of their poses"}};
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::blend_tool::declare(command, options);
  };
  spec.check = [&options] { return krok::blend_tool::check(options); };
  spec.run = [&options](krok::ToolContext& context) {
    return krok::blend_tool::run(options, context);
  };
  return krok::run_tool(spec, argc, argv);
}
