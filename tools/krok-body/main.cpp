#include <memory>

#include "tools/krok-body/make_model.h"

namespace {

krok::ToolSpec make_spec() {
  const auto options = std::make_shared<krok::body_tool::Options>();
  krok::ToolSpec spec;
  spec.name = "krok-body";
  spec.summary =
      "Generates a smooth closed body mesh around any skeleton, skinned to its joints, so that a "
      "capture can be viewed as a character";
  spec.inputs = "IN.anim|IN.model";
  spec.examples = {{"krok-body walk.anim -o walker.model",
                    "a body for the actor of a capture, about 10,000 vertices"},
                   {"krok-body dog.anim --detail high -o dog.model",
                    "bodies of other skeletons follow the bone lengths"}};
  spec.batch = {{".anim"}, krok::always(".model")};
  spec.declare = [options](krok::CommandOptions& command) { declare(command, *options); };
  spec.check = [options] { return check(*options); };
  spec.run = [options](krok::ToolContext& context) { return run(*options, context); };
  return spec;
}

}  // namespace

int main(int argc, char** argv) {
  return krok::run_tool(make_spec, argc, argv);
}
