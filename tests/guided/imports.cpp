#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "guided/targets.h"
#include "guided/tool_runs.h"
#include "tools/krok-import/options.h"

namespace krok::guided {

void import_scene(std::span<const std::byte> input) {
  if (input.empty()) return;
  clear_scratch();
  const std::string text(reinterpret_cast<const char*>(input.data()), input.size());
  const std::string scene = scratch(text.starts_with("glTF") ? "in.glb" : "in.gltf");
  std::ofstream(scene, std::ios::binary) << text;
  const std::string motion = scratch("out.anim"), model = scratch("out.model");
  const std::string report = scratch("report.json"), weights = scratch("weights.csv");
  // Not every scene has all of them; what it has is written.
  const std::vector<std::vector<std::string>> outputs = {
      {"-o", motion, "--save-model", model},
      {"-o", motion},
      {"--save-model", model},
      {"--save-character", scratch("out.character"), "--save-model", model},
      {"--save-morphs", scratch("out.exr"), "--morph-weights", weights},
      {"--save-cam", scratch("out.cam")}};
  for (std::vector<std::string> arguments : outputs) {
    arguments.insert(arguments.end(), {scene, "--json=" + report});
    const bool read = run_tool(cli::import::make_spec, arguments);
    if (std::filesystem::exists(report)) judge_report(report);
    if (!read) continue;
    if (std::filesystem::exists(motion)) judge_motion(motion);
    if (std::filesystem::exists(model)) judge_model(model);
    if (std::filesystem::exists(weights)) judge_table(weights);
    for (const auto& written : {motion, model, weights, report}) std::filesystem::remove(written);
  }
}

}  // namespace krok::guided
