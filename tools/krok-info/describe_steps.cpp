#include <fmt/format.h>

#include "formats/steps/parameter_names.h"
#include "formats/steps/steps.h"
#include "parametric/bounds.h"
#include "parametric/parameter.h"
#include "tools/krok-info/describe.h"

namespace krok::cli::info {

namespace {

// "length: 0.487 to 0.786 m (step.length)".
void add_parameters(const steps::StepsFile& steps, Description& out) {
  const parametric::Library& library = steps.library;
  const parametric::Bounds bounds = parametric::bounds_of(library);
  const std::vector<std::string> names = steps::parameter_names(steps);
  std::vector<std::string> lines;
  Json list = Json::array();
  for (std::size_t d = 0; d < names.size(); ++d) {
    const std::string measures = name_of(library.parameters[d], library.skeleton, library.keytimes);
    const std::string unit(unit_of(library.parameters[d]));
    const bool angle = unit == "rad";
    const double factor = angle ? 1 / kRadiansPerDegree : 1;
    lines.push_back(
        fmt::format("{}: {} to {} {} ({})", names[d], readable(bounds.lower[d] * factor, 3),
                    readable(bounds.upper[d] * factor, 3), angle ? "deg" : unit, measures));
    list.push_back({{"name", names[d]},
                    {"measures", measures},
                    {"unit", unit},
                    {"from", bounds.lower[d]},
                    {"to", bounds.upper[d]},
                    {"tolerance", library.parameters[d].tolerance}});
  }
  out.add("parameters", std::move(lines));
  out.json["parameters"] = std::move(list);
}

void add_weights(const steps::StepsFile& steps, Description& out) {
  if (!steps.weights) {
    out.add("weights", "none: not fitted");
    out.json["weights"] = nullptr;
    return;
  }
  const rbf::WeightFunction& weights = *steps.weights;
  out.add("weights",
          fmt::format("{} kernel, {}", rbf::kernel_name(weights.kernel),
                      count_of(static_cast<std::size_t>(weights.inserted()), "inserted point")));
  out.json["weights"] = {{"kernel", std::string(rbf::kernel_name(weights.kernel))},
                         {"centres", weights.centre_count()},
                         {"inserted", weights.inserted()}};
}

}  // namespace

Result<Description> describe_steps(const InputFile& file, ToolContext&) {
  const auto steps = steps::read(file.bytes());
  if (!steps) return steps.error();
  const parametric::Library& library = steps->library;
  Description out;
  out.what = "a step library (.steps)";
  out.json["kind"] = "steps";
  const bool left = library.swing == FootSide::left;
  out.add("steps", left ? "with the left foot" : "with the right foot");
  out.json["swing"] = left ? "left" : "right";
  out.add("joints", fmt::format("{}", library.skeleton.joint_count()));
  out.json["joints"] = library.skeleton.joint_count();
  out.add("keytimes", fmt::format("{}", fmt::join(library.keytimes, ", ")));
  out.json["keytimes"] = library.keytimes;
  add_parameters(*steps, out);
  out.add("examples", count_of(library.examples.size(), "motion"));
  Json examples = Json::array();
  for (const parametric::Example& example : library.examples) {
    examples.push_back({{"name", example.name},
                        {"mirrored", example.mirrored},
                        {"parameters", example.parameters},
                        {"frames", example.motion.frame_count()}});
  }
  out.json["examples"] = std::move(examples);
  add_weights(*steps, out);
  add_provenance(steps->provenance, out);
  return out;
}

}  // namespace krok::cli::info
