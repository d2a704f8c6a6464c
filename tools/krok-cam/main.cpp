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
      "Makes a camera: from keys, following a figure, going round it or standing still, as a .cam "
      "file or in glTF, by itself or beside a character";
  spec.inputs = "IN.json|IN.cam|IN.glb|IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-cam shot.json -o shot.cam", "through keys that a person wrote"},
      {"krok-cam walk.anim --follow hips -o shot.cam",
       "goes along, with the whole figure in the picture in all frames"},
      {"krok-cam walk.anim --orbit 20s --frame upper --into walk.glb -o film.glb",
       "goes round the upper body, a turn in 20 seconds, put into the character's own file"},
      {"krok-cam shot.cam --into walk.glb -o film.glb", "a camera that stands already, likewise"},
      {"krok-cam film.glb -o shot.cam", "takes it out again"},
      {"krok-cam captures/*.bvh --still --view left --out-dir cameras",
       "one camera for each, which sees all of its motion from the left"}};
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
