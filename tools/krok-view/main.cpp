#include "tools/krok-view/view.h"

int main(int argc, char** argv) {
  krok::view::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-view";
  spec.summary = "Makes a page that plays motions in any browser, from disk, without a network";
  spec.inputs = "IN...";
  spec.examples = {{"krok-view walk.bvh -o walk.html", "a capture, with a body made for it"},
                   {"krok-view before.anim after.anim --difference -o change.html",
                    "two motions in one place, joints coloured by how far apart they are"},
                   {"krok-view hero.model walk.anim shot.cam -o shot.html",
                    "a model, moved, seen by the recorded camera"},
                   {"krok-view hero.character walk.anim -o hero.html",
                    "a character with its materials, moved; without a motion it stands"}};
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::view::declare(command, options);
  };
  spec.run = [&options](krok::ToolContext& context) { return krok::view::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
