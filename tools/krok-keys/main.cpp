#include <memory>

#include "tools/krok-keys/find_and_write.h"
#include "tools/krok-keys/options.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::keys_tool::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-keys";
  spec.summary =
      "Detects foot contacts and gait keytimes, shows them, and writes them to an editable file "
      "beside the motion";
  spec.inputs = "IN.anim|IN.bvh|IN.amc";
  spec.examples = {
      {"krok-keys walk.anim", "prints what is detected, or walk.keys.json if that was edited"},
      {"krok-keys walk.anim -o walk.keys.json --plot walk.svg",
       "writes the file beside the motion, and a plot of the feet for checking"},
      {"krok-keys walk.anim -o walk.keys.json --set left_strike=1.25s,right_off=1.31s",
       "moves two keytimes; they are kept when the file is rebuilt"},
      {"krok-keys motions --out-dir motions", "for all motions of a folder, beside them"}};
  spec.exit_no = "--find steps was given and no step was found";
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
