#include <memory>

#include "tools/common/one_of.h"
#include "tools/common/option_kinds.h"
#include "tools/krok-export/export.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::ExportOptions>();
  krok::ToolSpec spec;
  spec.name = "krok-export";
  spec.summary = "Writes a motion as BVH, glTF or a table of world positions";
  spec.inputs = "IN";
  spec.examples = {{"krok-export walk.anim -o walk.glb", "the skeleton moves in any glTF viewer"},
                   {"krok-export walk.anim -o walk.csv",
                    "frame,time,joint,x,y,z: a row a frame and joint, in metres"},
                   {"krok-export capture.bvh -o capture.glb",
                    "straight from a capture; what was chosen in reading it is told with -v"},
                   {"krok-export walk.anim --format csv -o - | head", "the first rows"}};
  spec.batch = {{".anim", ".bvh", ".amc"},
                [options] { return krok::extension_of(options->format); }};
  spec.declare = [options](krok::CommandOptions& command) {
    using krok::ExportFormat;
    command
        .add_option(
            "input", options->input,
            "The motion: a .anim file, or a capture (BVH; AMC with its ASF beside it), which "
            "is read as krok-import reads it without options")
        .type_name("IN")
        .required();
    command
        .add_option("--format", options->format,
                    "bvh, glb, gltf (text, data inside) or csv; without it the output's extension "
                    "tells")
        .type_name("FORMAT")
        .transform(krok::one_of<ExportFormat>({{"bvh", ExportFormat::bvh},
                                               {"glb", ExportFormat::glb},
                                               {"gltf", ExportFormat::gltf},
                                               {"csv", ExportFormat::csv}}));
    command.add_option("--unit", options->unit, "BVH: the unit of lengths: m, cm, mm, in, ft")
        .type_name("UNIT")
        .default_str("cm");
    krok::add_whole(
        command, "--digits", options->digits,
        "BVH: decimals of angles in degrees, and of lengths in a centimetre; other "
        "units get more or fewer of the same fineness. 6 keep the motion to a millionth "
        "of a metre and of a radian",
        1, 15)
        .type_name("1..15")
        .default_str("6");
    command
        .add_option("--order", options->order,
                    "BVH: the order of the rotation channels: XYZ, XZY, YXZ, YZX, ZXY or ZYX")
        .type_name("ORDER")
        .transform(krok::one_of_words({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}))
        .default_str("ZXY");
    command
        .add_option("--reduce", options->reduce,
                    "glTF: leave out keys as long as each joint, and points 3 cm around it, stay "
                    "within this distance of where they were, such as 1mm; for a smaller file. "
                    "Without it each frame is a key")
        .type_name("LENGTH");
    command.add_flag_function(
        "--bones,!--no-bones", [options](std::int64_t sign) { options->bones = sign > 0; },
        "glTF: add a thin mesh for each bone, so that viewers show the skeleton (the "
        "default; --no-bones leaves joints alone)");
  };
  spec.check = [options] { return krok::check_export(*options); };
  spec.run = [options](krok::ToolContext& context) { return krok::run_export(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
