#include <fmt/format.h>

#include <optional>

#include "describe.h"
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
                    {"unit", reported_unit(unit)},
                    {"from", reported(bounds.lower[d], unit)},
                    {"to", reported(bounds.upper[d], unit)},
                    {"tolerance", reported(library.parameters[d].tolerance, unit)}});
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
                      counted(static_cast<std::size_t>(weights.inserted()), "inserted point")));
  out.json["weights"] = {{"kernel", std::string(rbf::kernel_name(weights.kernel))},
                         {"centres", weights.centre_count()},
                         {"inserted", weights.inserted()}};
}

// A number of the fit report; nothing where it is not there, as the report may be from anywhere.
std::optional<double> number_in(const Json& report, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!report.contains(at) || !report[at].is_number()) return std::nullopt;
  return report[at].get<double>();
}

// Where the report has what was measured last.
std::string last_errors(const Json& report) {
  if (report.contains("/polished/after"_json_pointer)) return "/polished/after";
  const Json rounds = report.value("rounds", Json::array());
  if (rounds.is_array() && !rounds.empty()) {
    return fmt::format("/rounds/{}/after", rounds.size() - 1);
  }
  return "/before";
}

// What the fit measured: held-out errors, the range of the weights, leave-one-out.
void add_fit(const steps::StepsFile& steps, Description& out) {
  const Json report = Json::parse(steps.report, nullptr, false);
  if (!report.is_object()) return;
  const std::string errors = last_errors(report);
  Json json = Json::object();
  const auto get = [&](const char* key, const std::string& pointer) {
    const auto value = number_in(report, pointer);
    if (value) json[key] = *value;
    return value;
  };
  std::vector<std::string> lines;
  const std::vector<std::string> names = steps::parameter_names(steps);
  for (std::size_t d = 0; d < names.size(); ++d) {
    // A name may hold the separators of a pointer.
    Json::json_pointer within(errors + "/within");
    within.push_back(names[d]);
    const auto most = number_in(report, (within / "largest").to_string());
    const auto mean = number_in(report, (within / "mean").to_string());
    if (!most || !mean) continue;
    const std::string_view unit = unit_of(steps.library.parameters[d]);
    const double factor = unit == "rad" ? 1 / kRadiansPerDegree : 1000;
    lines.push_back(fmt::format("{}: {} {} at most, {} in the mean (held-out points)", names[d],
                                readable(*most * factor, 3),
                                unit == "rad" ? "deg"
                                : unit == "s" ? "ms"
                                              : "mm",
                                readable(*mean * factor, 3)));
    json["errors"][names[d]] = {{"largest", reported(*most, unit)},
                                {"mean", reported(*mean, unit)}};
  }
  out.add("errors", std::move(lines));
  const auto least = get("least_weight", errors + "/least_weight");
  const auto largest = get("largest_weight", errors + "/largest_weight");
  if (least && largest) {
    out.add("range",
            fmt::format("weights from {} to {}", readable(*least, 3), readable(*largest, 3)));
  }
  const auto smoothing = get("smoothing", "/smoothing");
  if (smoothing && *smoothing > 0) out.add("smoothing", readable(*smoothing, 3));
  // None is measured if no example is inside the bounds of the others.
  const auto inside = number_in(report, "/leave_one_out/inside");
  if (inside && *inside == 0) {
    out.add("left out", "not measured: no example lies between the others");
    for (const char* key : {"left_out", "left_out_linear", "left_out_nearest"}) json[key] = nullptr;
    out.json["fit"] = std::move(json);
    return;
  }
  const auto weighted = get("left_out", "/leave_one_out/weighted");
  const auto linear = get("left_out_linear", "/leave_one_out/linear");
  const auto nearest = get("left_out_nearest", "/leave_one_out/nearest");
  if (weighted && linear && nearest) {
    out.add("left out",
            fmt::format("each example from the others: {} mm; affine fit {}, nearest {}",
                        readable(*weighted * 1000, 3), readable(*linear * 1000, 3),
                        readable(*nearest * 1000, 3)));
  }
  out.json["fit"] = std::move(json);
}

}  // namespace

Result<Description> describe_steps(const InputFile& file, const SkeletonOptions&, ToolContext&) {
  const auto steps = steps::read(file.bytes());
  if (!steps) return steps.error();
  const parametric::Library& library = steps->library;
  Description out("a step library (.steps)", "steps");
  const bool left = library.swing == FootSide::left;
  out.add("steps", left ? "with the left foot" : "with the right foot");
  out.json["swing"] = left ? "left" : "right";
  out.add("joints", fmt::format("{}", library.skeleton.joint_count()));
  out.json["joints"] = library.skeleton.joint_count();
  out.add("keytimes", fmt::format("{}", fmt::join(library.keytimes, ", ")));
  out.json["keytimes"] = library.keytimes;
  add_parameters(*steps, out);
  out.add("examples", counted(library.examples.size(), "motion"));
  Json examples = Json::array();
  for (const parametric::Example& example : library.examples) {
    std::vector<double> parameters = example.parameters;
    for (std::size_t d = 0; d < parameters.size(); ++d) {
      parameters[d] = reported(parameters[d], unit_of(library.parameters[d]));
    }
    examples.push_back({{"name", example.name},
                        {"mirrored", example.mirrored},
                        {"parameters", std::move(parameters)},
                        {"frames", example.motion.frame_count()}});
  }
  out.json["examples"] = std::move(examples);
  add_weights(*steps, out);
  add_fit(*steps, out);
  add_provenance(steps->provenance, out);
  return out;
}

}  // namespace krok::cli::info
