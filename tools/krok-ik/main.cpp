#include <memory>

#include "tools/krok-ik/ik_file.h"
#include "tools/krok-ik/options.h"

namespace {

using krok::ik_tool::Arguments;

krok::ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  krok::ToolSpec spec;
  spec.name = "krok-ik";
  spec.summary =
      "Brings joints of a motion to goals by inverse kinematics, within the joints' ranges of "
      "motion";
  spec.inputs = "IN.anim";
  spec.needs_output = false;  // --write-limits alone is enough
  spec.examples = {
      {"krok-ik walk.anim --reach RightHand=-0.4m,1.1m,0.5m@1s..1.5s -o touch.anim",
       "the hand is at the place from 1 to 1.5 s and moves there and back in half a second each"},
      {"krok-ik walk.anim --goals goals.json --limits auto -o reach.anim -v",
       "goals keyed in time; limits from published ranges of motion"},
      {"krok-ik walk.anim --look-at head=2m,1.5m,3m@0s..2s --stiffness spine=0.9 -o look.anim",
       "the head turns to a place, mostly by the neck"},
      {"krok-ik walk.anim --learn-limits run.anim --learn-limits dance.anim --write-limits "
       "actor.limits.json",
       "the ranges that an actor uses in captures, as a file for --limits"}};
  spec.batch = {{".anim", ".bvh", ".amc"}, krok::always(".anim")};
  spec.declare = [arguments](krok::CommandOptions& command) { declare(command, *arguments); };
  spec.check = [arguments]() -> krok::Status {
    const auto options = understand(*arguments);
    return options ? krok::Status() : options.error();
  };
  spec.run = [arguments](krok::ToolContext& context) -> krok::Result<int> {
    const auto options = understand(*arguments);
    if (!options) return options.error();
    return run(*options, context);
  };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
