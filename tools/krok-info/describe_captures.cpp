#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "describe.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_motion.h"
#include "formats/steps/steps.h"
#include "parametric/bounds.h"
#include "parametric/parameter.h"
#include "tools/krok-info/describe.h"
#include "tools/shared/role_report.h"

namespace krok::cli::info {

namespace {

// Facts common to all captures. `measured` names the pose that the size is measured in.
Status add_capture(const Capture& capture, const std::string& measured, const SkeletonOptions& how,
                   Description& out) {
  const Clip& clip = capture.clip;
  if (Status status = add_skeleton(clip.skeleton, how, out); !status) return status.error();
  std::vector<Vec3> positions;
  for (const Transform& joint : clip.skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, measured, out);
  add_conventions(capture.conventions, out);
  return {};
}

// Without its frames, if they need not be in memory to find faults.
Result<bvh::Capture> read_bvh(const InputFile& file, const bvh::ReadOptions& options,
                              int& frame_count) {
  if (auto opened = bvh::open(file.text(), file.path(), options,
                              [&](std::size_t offset) { file.release_before(offset); })) {
    frame_count = opened->frames.frame_count;
    if (read_through(opened->frames, options.jobs)) return static_cast<bvh::Capture&>(*opened);
  }
  auto capture = bvh::read(file.text(), file.path(), options);
  if (capture) frame_count = capture->clip.frame_count();
  return capture;
}

std::vector<int> depths_of(const Skeleton& skeleton) {
  std::vector<int> depths;
  for (const int parent : skeleton.parents) {
    depths.push_back(parent < 0 ? 0 : depths[at(parent)] + 1);
  }
  return depths;
}

}  // namespace

Result<Description> describe_bvh(const InputFile& file, const SkeletonOptions& how,
                                 ToolContext& context) {
  bvh::ReadOptions options;
  options.jobs = context.jobs;
  options.progress = context.progress;
  int frame_count = 0;
  const auto capture = read_bvh(file, options, frame_count);
  if (!capture) return capture.error();
  context.diagnose(capture->diagnostics);
  Description out("a capture (BVH), as read by krok-import", "bvh");
  add_timing(frame_count, capture->clip.rate, out);
  out.json["frames_announced"] = capture->frames_announced;
  out.json["frame_time"] = capture->frame_time;
  if (Status status = add_capture(*capture, "joints with all rotations 0", how, out); !status)
    return status.error();
  add_choice("positions", capture->positions, out);
  out.json["rest_frame"] = capture->rest_frame_found;
  if (capture->rest_frame_found)
    out.add("rest pose", "frame 0; it is kept, --skip-rest-frame auto of krok-import drops it");
  return out;
}

Result<Description> describe_acclaim(const InputFile& file, const SkeletonOptions& how,
                                     ToolContext& context) {
  io::CaptureReading reading;
  reading.jobs = context.jobs;
  reading.progress = context.progress;
  Description out;
  const Status status =
      io::use_capture(file, context, reading, true, [&](const io::OpenedCapture& opened) -> Status {
        const Capture& capture = *opened.capture;
        const bool is_motion = opened.details.skeleton.has_value();
        out.what = is_motion ? "a capture (AMC), as read by krok-import"
                             : "a skeleton (ASF), as read by krok-import";
        out.json["kind"] = is_motion ? "amc" : "asf";
        if (is_motion) {
          out.add("skeleton", fmt::format("{} ({})", opened.details.skeleton->path,
                                          opened.details.skeleton->reason));
          out.json["skeleton_file"] = opened.details.skeleton->path;
        }
        context.diagnose(capture.diagnostics);
        if (is_motion) add_timing(capture.clip.frame_count(), capture.clip.rate, out);
        return add_capture(capture, "joints in the reference pose", how, out);
      });
  if (!status) return status.error();
  return out;
}

Result<Description> describe_motion(const InputFile& file, const SkeletonOptions& how,
                                    ToolContext& context) {
  const auto clip = io::open_motion(file, context);
  if (!clip) return clip.error();
  const std::string ending = extension(file.path());
  Description out(fmt::format("a motion ({})", ending), ending.empty() ? ending : ending.substr(1));
  add_timing(clip->frame_count(), clip->rate, out);
  if (Status status = add_skeleton(clip->skeleton, how, out); !status) return status.error();
  std::vector<Vec3> positions;
  for (const Transform& joint : clip->skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, "joints in the reference pose", out);
  return out;
}

void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, double metres,
                  Description& out) {
  const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
  std::string joints = grouped(skeleton.joint_count());
  if (ends > 0) joints += fmt::format(", {} of them end sites", ends);
  out.add("joints", joints);
  for (RoleRow& row : role_rows(skeleton, map)) out.add(std::move(row.label), std::move(row.text));

  auto stature = stature_of(skeleton, map);
  if (stature) {
    stature->metres *= metres;
    stature->uncertainty *= metres;
    out.add("stature",
            fmt::format("{} m, within {} m, by the lengths of legs, spine and arms",
                        readable(stature->metres, 3), readable(stature->uncertainty, 2)));
  }
  out.json["stature"] = stature_json(stature);
  out.json["joints"] = skeleton.joint_count();
  out.json["end_sites"] = ends;
  out.json.update(roles_json(skeleton, map));
  out.json["skeleton"] = Json::array();
  std::vector<std::string> lines;
  const std::vector<int> depths = depths_of(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string label = role_label(map, j);
    lines.push_back(fmt::format("{:<23} {:>{}}{}", label == "none" ? "-" : label, "",
                                2 * std::min(depths[at(j)], 40), skeleton.names[at(j)]));
    const int parent = skeleton.parents[at(j)];
    const Vec3 place = metres * skeleton.reference[at(j)].position;
    const Quat& turn = skeleton.reference[at(j)].orientation;
    out.json["skeleton"].push_back(
        {{"joint", skeleton.names[at(j)]},
         {"parent", parent < 0 ? Json() : Json(skeleton.names[at(parent)])},
         {"role", label == "none" ? Json() : Json(label)},
         {"position", {place.x(), place.y(), place.z()}},
         {"orientation", {turn.x(), turn.y(), turn.z(), turn.w()}}});
  }
  if (verbose) out.add("roles", std::move(lines));
}

Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out) {
  const auto map = options.roles(skeleton);
  if (!map) return map.error();
  add_skeleton(skeleton, *map, options.verbose, 1, out);
  return {};
}

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
