#include "tools/krok-morph/actions.h"
#include "tools/krok-morph/options.h"

namespace krok::morph {

Result<int> run(const Options& options, ToolContext& context) {
  switch (options.action) {
    case Action::pack:
      return pack(options, context);
    case Action::unpack:
      return unpack(options, context);
    case Action::info:
      return info(options, context);
    case Action::bake:
      return bake(options, context);
    case Action::frames:
      return frames(options, context);
  }
  return Error("internal", "no such action");
}

}  // namespace krok::morph

int main(int argc, char** argv) {
  krok::morph::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-morph";
  spec.summary =
      "Morph targets: shapes of one mesh packed into a float texture, taken out again, and shown "
      "over time; and key-frame meshes, whose shapes come at times";
  spec.inputs = "pack|unpack|info|bake|frames IN...";
  spec.examples = {
      {"krok-morph pack face.obj smile.obj blink.obj -o face.exr",
       "two targets, called smile and blink, of the mesh in face.obj"},
      {"krok-morph pack hero.glb -o hero.exr", "the targets that a glTF character brings"},
      {"krok-morph info face.exr face.obj", "what they are, and how far each moves the mesh"},
      {"krok-morph unpack face.exr face.obj --out-dir shapes", "back to shapes/smile.obj, ..."},
      {"krok-morph bake face.exr face.obj --weights talk.json -o talk.glb",
       "the face over time, by keys that a person wrote"},
      {"krok-morph frames flag.json -o flag.glb", "shapes at times, and what is between them"},
      {"krok-morph frames flag_shapes --spacing 0.5s --between hermite -o flag.pc2",
       "a folder of them, half a second apart, on curves, as a point cache"}};
  spec.needs_output = false;
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::morph::declare(command, options);
  };
  spec.check = [&options] { return krok::morph::check(options); };
  spec.run = [&options](krok::ToolContext& context) { return krok::morph::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
