#include <memory>

#include "tools/common/one_of.h"
#include "tools/common/option_kinds.h"
#include "tools/krok-export/export.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::ExportOptions>();
  krok::ToolSpec spec;
  spec.name = "krok-export";
  spec.summary = "Exports a motion as BVH, glTF or a CSV table of world positions";
  spec.inputs = "IN";
  spec.examples = {
      {"krok-export walk.anim -o walk.glb", "the animated skeleton, for any glTF viewer"},
      {"krok-export walk.anim -o walk.csv",
       "frame,time,joint,x,y,z: one row per frame and joint, in metres"},
      {"krok-export capture.bvh -o capture.glb",
       "directly from a capture; -v prints the detected conventions"},
      {"krok-export walk.anim --format csv -o - | head", "the first rows"}};
  spec.batch = {{".anim", ".bvh", ".amc"},
                [options] { return krok::extension_of(options->format); }};
  spec.declare = [options](krok::CommandOptions& command) {
    using krok::ExportFormat;
    command
        .add_option("input", options->input,
                    "Motion: a .anim file, or a capture (BVH; AMC with its ASF beside it), read as "
                    "by krok-import without options")
        .type_name("IN")
        .required();
    command
        .add_option("--format", options->format,
                    "bvh, glb, gltf (text, embedded data) or csv; default: the output's extension")
        .type_name("FORMAT")
        .transform(krok::one_of<ExportFormat>({{"bvh", ExportFormat::bvh},
                                               {"glb", ExportFormat::glb},
                                               {"gltf", ExportFormat::gltf},
                                               {"csv", ExportFormat::csv}}));
    command.add_option("--unit", options->unit, "BVH: length unit: m, cm, mm, in, ft")
        .type_name("UNIT")
        .default_str("cm");
    krok::add_whole(
        command, "--digits", options->digits,
        "BVH: decimal places of angles in degrees and lengths in centimetres; adjusted to the same "
        "precision for other units. 6 preserve the motion to 1e-6 metres and radians",
        1, 15)
        .type_name("1..15")
        .default_str("6");
    command
        .add_option("--order", options->order,
                    "BVH: order of the rotation channels: XYZ, XZY, YXZ, YZX, ZXY or ZYX")
        .type_name("ORDER")
        .transform(krok::one_of_words({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}))
        .default_str("ZXY");
    command
        .add_option("--reduce", options->reduce,
                    "glTF: reduce keys for a smaller file; joints, and points 3 cm around them, "
                    "move by at most this distance, such as 1mm. By default each frame is a key")
        .type_name("LENGTH");
    command.add_flag_function(
        "--bones,!--no-bones", [options](std::int64_t sign) { options->bones = sign > 0; },
        "glTF: add a thin mesh for each bone, so that viewers display the skeleton (default; "
        "--no-bones: joints only)");
  };
  spec.check = [options] { return krok::check_export(*options); };
  spec.run = [options](krok::ToolContext& context) { return krok::run_export(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
