#include "info.h"

int main(int argc, char** argv) {
  krok::info::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-info";
  spec.summary =
      "What is in a file: motions (.anim), models (.model), cameras (.cam), captures (.bvh, .asf, "
      ".amc), glTF (.glb, .gltf)";
  spec.inputs = "FILE...";
  spec.examples = {{"krok-info walk.anim",
                    "Frames, rate, duration, size, provenance, and what the joints are in a body."},
                   {"krok-info -v capture.bvh",
                    "Also each joint with its role in the body, and the reader's notes."},
                   {"krok-info --json *.model > models.json", "The same for programs."}};
  spec.has_output = false;
  spec.declare = [&](CLI::App& app) {
    app.add_option("FILE", options.files, "Files of any of these kinds; - is standard input")
        ->type_name("")
        ->required();
    app.add_option("--map", options.map,
                   "What joints are, where their names do not tell: a role map (JSON)")
        ->type_name("IN.json");
  };
  spec.run = [&](krok::ToolContext& context) { return krok::info::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
