#include <fmt/format.h>

#include "formats/anim/anim.h"
#include "formats/model/model_format.h"
#include "samples/candy_wrapper/forearm.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-forearm: writes a generated forearm as .model, and the motion that twists it as .anim.

namespace {

using namespace krok;
using namespace krok::cli;

Result<int> run(ToolContext& context, const std::string& model_path) {
  const Model model = samples::make_forearm();
  const Clip clip = samples::make_twist();
  OutputSet outputs(context);
  const auto write_model = [&](OutputFile& file) { return model::write(model, {}, file); };
  if (Status status = outputs.add(model_path, write_model); !status) return status.error();
  const auto write_clip = [&](OutputFile& file) { return anim::write(clip, {}, file); };
  if (Status status = outputs.add(context.output, write_clip); !status) return status.error();
  if (Status status = outputs.finish(); !status) return status.error();
  context.log(fmt::format("{}: {} vertices, {} triangles", model_path, model.positions.size(),
                          model.triangles.size()));
  context.log(
      fmt::format("{}: the wrist twists from 0 to 180 degrees, one per frame", context.output));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  std::string model_path;
  ToolSpec spec;
  spec.name = "make-forearm";
  spec.summary = "Generates a forearm mesh and a motion that twists its wrist";
  spec.inputs = "";
  spec.examples = {{"make-forearm --model forearm.model -o twist.anim",
                    "a mesh with two joints, and a 180-degree wrist twist in three seconds"}};
  spec.declare = [&](CommandOptions& command) {
    command.add_option("--model", model_path, "Output file for the mesh")
        .type_name("OUT.model")
        .required()
        .group("Forearm");
  };
  spec.run = [&](ToolContext& context) { return run(context, model_path); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
