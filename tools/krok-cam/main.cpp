#include <memory>

#include "tools/krok-cam/make_camera.h"
#include "tools/krok-cam/options.h"

namespace {

using krok::cam_tool::Arguments;

krok::Result<int> run_typed(const Arguments& arguments, krok::ToolContext& context) {
  const auto options = understand(arguments);
  if (!options) return options.error();
  return run(*options, context);
}

krok::ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  krok::ToolSpec spec;
  spec.name = "krok-cam";
  spec.summary =
      "Makes a camera from keys, or films a motion by following, orbiting or static "
      "framing; writes a .cam file or glTF, separate or added to a character";
  spec.inputs = "IN.json|IN.cam|IN.glb|IN.anim|IN.bvh|IN.amc";
  spec.examples = {{"krok-cam shot.json -o shot.cam", "a camera from hand-written keys"},
                   {"krok-cam walk.anim --follow hips -o shot.cam",
                    "follows the hips, with the whole character in every frame"},
                   {"krok-cam walk.anim --orbit 20s --frame upper --into walk.glb -o film.glb",
                    "orbits the upper body once in 20 seconds, added to the character's file"},
                   {"krok-cam shot.cam --into walk.glb -o film.glb", "adds an existing camera"},
                   {"krok-cam film.glb -o shot.cam", "extracts it"},
                   {"krok-cam captures/*.bvh --still --view left --out-dir cameras",
                    "one camera per file, framing the whole motion from the left"}};
  spec.batch = {{".anim", ".bvh", ".amc"},
                [arguments]() -> krok::Result<std::string> { return ending(*arguments); }};
  spec.declare = [arguments](krok::CommandOptions& command) { declare(command, *arguments); };
  spec.check = [arguments]() -> krok::Status {
    const auto options = understand(*arguments);
    return options ? krok::Status() : options.error();
  };
  spec.run = [arguments](krok::ToolContext& context) { return run_typed(*arguments, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
