#include "tools/krok-import/import.h"

int main(int argc, char** argv) {
  krok::import::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-import";
  spec.summary = "Brings a motion capture into Krok's own format";
  spec.inputs = "IN";
  spec.examples = {
      {"krok-import walk.bvh -o walk.anim -v",
       "works out unit and axes by itself and says what it chose"},
      {"krok-import take7.bvh -o take7.anim --model actor.model --unit in --up z --forward -y",
       "a capture in inches with +Z up, and its skeleton as a model"},
      {"krok-import 01_01.amc --skeleton 01.asf -o walk.anim",
       "an Acclaim motion with its skeleton, as the CMU collection has them"},
      {"krok-import broken.bvh -o broken.anim --repair --json",
       "fills faulty frames and lists the repairs for a script"}};
  spec.declare = [&](CLI::App& app) { krok::import::declare_options(app, options); };
  spec.run = [&](krok::ToolContext& context) { return krok::import::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
