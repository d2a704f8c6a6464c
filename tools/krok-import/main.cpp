#include <memory>

#include "tools/krok-import/import.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::import::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-import";
  spec.summary = "Converts motion captures and characters to Krok's formats";
  spec.inputs = "IN";
  spec.needs_output = false;  // --model or --cam alone is enough
  spec.examples = {
      {"krok-import walk.bvh -o walk.anim -v", "detects unit and axes and prints them"},
      {"krok-import take7.bvh -o take7.anim --model actor.model --unit in --up z --forward -y",
       "a capture in inches with +Z up, and its skeleton as a model"},
      {"krok-import 01_01.amc --skeleton 01.asf -o walk.anim",
       "an Acclaim motion with its skeleton, as in the CMU database"},
      {"krok-import hero.glb --clip Walk -o walk.anim --model hero.model --cam shot.cam",
       "one animation of a character, its mesh and skin, and the camera"},
      {"krok-import hero.glb --clip all -o 'hero_{clip}.anim' --morphs face.exr",
       "all animations, one file each, and the morph targets"},
      {"krok-import hero.glb --character hero.character",
       "the whole character: mesh, materials, textures and expressions"},
      {"krok-import broken.bvh -o broken.anim --repair --json",
       "repairs damaged frames and lists the repairs for a script"},
      {"krok-import captures --out-dir motions --keep-going",
       "all captures in a folder; run again, it processes only new, changed and failed files"}};
  // Only files with motion; an Acclaim skeleton or an MD5 mesh is read with the motion beside it.
  spec.batch = {
      {".bvh", ".amc", ".glb", ".gltf", ".fbx", ".dae", ".smd", ".ms3d", ".ase", ".md5anim"},
      [options]() -> krok::Result<std::string> {
        return std::string(options->clip == "all" ? "_{clip}.anim" : ".anim");
      }};
  spec.declare = [options](krok::CommandOptions& command) {
    krok::import::declare_options(command, *options);
  };
  spec.check = [options] { return krok::import::check(*options); };
  spec.run = [options](krok::ToolContext& context) { return krok::import::run(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
