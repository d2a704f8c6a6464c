#include <memory>

#include "tools/krok-keys/find_and_write.h"
#include "tools/krok-keys/options.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::keys_tool::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-keys";
  spec.summary =
      "Finds when the feet stand and the keytimes of a gait, shows them, and keeps them in a file "
      "beside the motion, which people may edit";
  spec.inputs = "IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-keys walk.anim", "shows what is found, or what stands in walk.keys.json if edited"},
      {"krok-keys walk.anim -o walk.keys.json --plot walk.svg",
       "writes the file beside the motion, and a plot of the feet to judge it by"},
      {"krok-keys walk.anim -o walk.keys.json --set left_strike=1.25s,right_off=1.31s",
       "moves two keytimes; they stay when the file is made anew"},
      {"krok-keys motions --out-dir motions", "for every motion of a folder, beside it"}};
  spec.exit_no = "--find steps was asked for and no step was found";
  spec.needs_output = false;
  spec.batch = {{".anim", ".bvh", ".amc"}, krok::always(".keys.json")};
  spec.declare = [options](krok::CommandOptions& command) { declare(command, *options); };
  spec.check = [options] { return check(*options); };
  spec.run = [options](krok::ToolContext& context) { return run(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
