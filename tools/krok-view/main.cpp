#include "tools/krok-view/view.h"

int main(int argc, char** argv) {
  krok::view::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-view";
  spec.summary = "Makes an HTML page that plays motions offline in any browser";
  spec.inputs = "IN...";
  spec.examples = {{"krok-view walk.bvh -o walk.html", "a capture, with a generated body"},
                   {"krok-view before.anim after.anim --difference -o change.html",
                    "two motions at the same position, joints coloured by their "
                    "distance"},
                   {"krok-view hero.model walk.anim shot.cam -o shot.html",
                    "an animated model, viewed through a recorded camera"},
                   {"krok-view hero.character walk.anim -o hero.html",
                    "an animated character with its materials; without a motion, in "
                    "its reference pose"}};
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::view::declare(command, options);
  };
  spec.run = [&options](krok::ToolContext& context) { return krok::view::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
