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
  return Error("internal", "unknown action");
}

}  // namespace krok::morph

int main(int argc, char** argv) {
  krok::morph::Options options;
  krok::ToolSpec spec;
  spec.name = "krok-morph";
  spec.summary =
      "Packs morph targets into a float texture, unpacks and animates them; bakes key-frame meshes";
  spec.inputs = "pack|unpack|info|bake|frames IN...";
  spec.examples = {
      {"krok-morph pack face.obj smile.obj blink.obj -o face.exr",
       "two targets, smile and blink, of the mesh in face.obj"},
      {"krok-morph pack hero.glb -o hero.exr", "the targets of a glTF character"},
      {"krok-morph info face.exr face.obj", "lists the targets and how far each moves the mesh"},
      {"krok-morph unpack face.exr face.obj --out-dir shapes", "back to shapes/smile.obj, ..."},
      {"krok-morph bake face.exr face.obj --weights talk.json -o talk.glb",
       "animates the face with hand-written keys"},
      {"krok-morph frames flag.json -o flag.glb", "a key-frame mesh, interpolated between shapes"},
      {"krok-morph frames flag_shapes --spacing 0.5s --between hermite -o flag.pc2",
       "a folder of shapes every 0.5 s, cubic interpolation, as a point cache"}};
  spec.needs_output = false;
  spec.declare = [&options](krok::CommandOptions& command) {
    krok::morph::declare(command, options);
  };
  spec.check = [&options] { return krok::morph::check(options); };
  spec.run = [&options](krok::ToolContext& context) { return krok::morph::run(options, context); };
  return krok::run_tool(spec, argc, argv);
}
