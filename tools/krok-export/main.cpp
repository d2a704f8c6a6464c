#include "tools/common/one_of.h"
#include "tools/krok-export/export.h"

int main(int argc, char** argv) {
  krok::ExportOptions options;
  krok::ToolSpec spec;
  spec.name = "krok-export";
  spec.summary = "Writes a motion as BVH, glTF or a table of world positions";
  spec.inputs = "IN.anim";
  spec.examples = {{"krok-export walk.anim -o walk.glb", "the skeleton moves in any glTF viewer"},
                   {"krok-export walk.anim -o walk.csv",
                    "frame,time,joint,x,y,z: a row a frame and joint, in metres"},
                   {"krok-export walk.anim --format csv -o - | head", "the first rows"}};
  spec.declare = [&](CLI::App& app) {
    using krok::ExportFormat;
    app.add_option("input", options.input, "The motion")->type_name("IN.anim")->required();
    app.add_option("--format", options.format,
                   "bvh, glb, gltf (text, data inside) or csv; without it the output's extension "
                   "tells")
        ->type_name("FORMAT")
        ->transform(krok::one_of<ExportFormat>({{"bvh", ExportFormat::bvh},
                                                {"glb", ExportFormat::glb},
                                                {"gltf", ExportFormat::gltf},
                                                {"csv", ExportFormat::csv}}));
    app.add_option("--unit", options.unit, "BVH: the unit of lengths: m, cm, mm, in, ft")
        ->type_name("UNIT")
        ->default_str("cm");
    app.add_flag_function(
        "--bones,!--no-bones", [&](std::int64_t sign) { options.bones = sign > 0; },
        "glTF: add a thin mesh for each bone, so that viewers show the skeleton (the "
        "default; --no-bones leaves joints alone)");
  };
  spec.run = [&](krok::ToolContext& context) { return krok::run_export(options, context); };
  return krok::run_tool(spec, argc, argv);
}
