#include <string>
#include <utility>
#include <vector>

#include "formats/io/open_character.h"
#include "formats/model/model_format.h"
#include "math/quaternion.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// make-bad-reference: a body whose skeleton is bound with its arms lowered, while the mesh has them
// where they were.

namespace {

using namespace krok;
using namespace krok::cli;

Result<int> run(ToolContext& context, const std::string& body, double angle) {
  auto actor = io::open_actor(body, context, {});
  if (!actor) return actor.error();
  Model model = std::move(actor->model);
  Skeleton& skeleton = model.skeleton;
  for (const auto& [name, side] : {std::pair("LeftArm", -1.0), std::pair("RightArm", 1.0)}) {
    const int arm = skeleton.find(name);
    const Quat turn = from_rotation_vector(Vec3(0, 0, side * angle));
    const Vec3 centre = skeleton.reference[static_cast<std::size_t>(arm)].position;
    std::vector<char> moves(skeleton.names.size(), 0);
    for (std::size_t j = 0; j < moves.size(); ++j) {
      const int parent = skeleton.parents[j];
      moves[j] = static_cast<int>(j) == arm ||
                 (parent >= 0 && moves[static_cast<std::size_t>(parent)] != 0);
      Transform& joint = skeleton.reference[j];
      if (moves[j] != 0) {
        joint = {turn * (joint.position - centre) + centre, turn * joint.orientation};
      }
    }
  }
  Status status = write_output(context, context.output,
                               [&](OutputFile& file) { return model::write(model, {}, file); });
  if (!status) return status.error();
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  std::string body;
  double angle = 0;
  ToolSpec spec;
  spec.name = "make-bad-reference";
  spec.summary = "Binds a body to a skeleton whose arms are lowered";
  spec.inputs = "BODY.model";
  spec.examples = {{"make-bad-reference body.model --lower 45deg -o bad.model",
                    "the mesh in its T-pose, the bones of the arms 45 degrees below"}};
  spec.declare = [&](CommandOptions& command) {
    command.add_option("body IN.model", body, "A body from krok-body").required();
    command.add("--lower ANGLE", angle, krok::cli::angle(), "By how much the arms are lowered",
                "45deg");
  };
  spec.run = [&](ToolContext& context) { return run(context, body, angle); };
  return run_tool([&spec] { return spec; }, argc, argv);
}
