#include <memory>

#include "tools/krok-retarget/retarget_file.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::retarget_tool::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-retarget";
  spec.summary = "Retargets a motion to another skeleton";
  spec.inputs = "--onto IN.model|IN.anim IN.anim";
  spec.examples = {{"krok-retarget --onto hero.model walk.anim -o hero_walk.anim -v",
                    "joints are mapped by role; -v prints the mapping"},
                   {"krok-retarget --map rig.json --onto hero.model take.anim -o hero_take.anim",
                    "rig.json gives the roles of unusual joint names: {\"joints\": {\"Bone_012\": "
                    "\"left_hand\"}}"},
                   {"krok-retarget --onto hero.model motions --out-dir hero_motions",
                    "all motions in a folder"}};
  spec.batch = {{".anim", ".bvh", ".amc"}, krok::always(".anim")};
  spec.declare = [options](krok::CommandOptions& command) { declare(command, *options); };
  spec.check = [options] { return check(*options); };
  spec.run = [options](krok::ToolContext& context) { return run(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
