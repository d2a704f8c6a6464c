#include "info.h"
#include "tools/common/role_input.h"

int main(int argc, char** argv) {
  krok::info::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-info";
  spec.summary =
      "Prints the contents of files: motions (.anim), models (.model), cameras (.cam), step "
      "libraries "
      "(.steps), materials (.material), characters (.character; glTF, FBX, COLLADA, SMD, MS3D, "
      "3DS, ASE, MD5), captures (.bvh, .asf, .amc)";
  spec.inputs = "FILE...";
  spec.examples = {
      {"krok-info walk.anim", "frames, rate, duration, size, provenance and joint roles"},
      {"krok-info -v capture.bvh", "also each joint with its role, and the reader's notes"},
      {"krok-info --json *.model > models.json", "the same as JSON for scripts"}};
  spec.has_output = false;
  spec.declare = [&](krok::CommandOptions& command) {
    command.add_option("FILE", options.files, "Files of these kinds; - is standard input")
        .type_name("")
        .required();
    krok::add_map_option(command, options.map);
  };
  spec.run = [&](krok::ToolContext& context) { return krok::info::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
