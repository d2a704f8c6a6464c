#include <memory>

#include "tools/krok-skin/options.h"
#include "tools/krok-skin/skin.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::skinning::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-skin";
  spec.summary =
      "Skins a mesh with a skeleton's motion and writes glTF, a point cache or OBJ files";
  spec.inputs = "IN.model IN.anim";
  spec.examples = {
      {"krok-skin body.model walk.anim -o walk.glb",
       "baked vertex animation, for viewers without skinning"},
      {"krok-skin body.model walk.anim --as rig -o walk.glb", "a rig for a game engine or Blender"},
      {"krok-skin body.model walk.anim --as pose --time 1.5s -o pose.glb", "one pose"},
      {"krok-skin hero.character walk.anim --weights smile.csv --as rig -o hero.glb",
       "a character with its materials, eyes and expressions"},
      {"krok-skin body.model walk.anim -o walk.pc2", "a point cache for Blender or 3ds Max"}};
  spec.batch = {{".anim"}, krok::always(".glb")};
  spec.declare = [options](krok::CommandOptions& command) {
    krok::skinning::declare_options(command, *options);
  };
  spec.check = [options] { return krok::skinning::check(*options); };
  spec.run = [options](krok::ToolContext& context) {
    return krok::skinning::run(*options, context);
  };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
