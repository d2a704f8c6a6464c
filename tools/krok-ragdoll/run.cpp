#include "tools/krok-ragdoll/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/goals/goals.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "ik/limits.h"
#include "ragdoll/bodies.h"
#include "ragdoll/world.h"
#include "terrain/surface.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/fall.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kReach = 10;         // metres around the fall
constexpr double kTolerance = 0.001;  // metres

Result<std::vector<std::array<Vec3, 3>>> triangles_of(const Terrain& terrain, const Vec3& centre) {
  // Around whole metres, so that the same ground has the same triangles wherever one falls there.
  const Vec2 middle(std::round(centre.x()), std::round(centre.z()));
  const Vec2 reach(kReach, kReach);
  const auto surface = terrain::surface_of(terrain, {middle - reach, middle + reach, kTolerance});
  if (!surface) return surface.error();
  std::vector<std::array<Vec3, 3>> triangles;
  for (const auto& corners : surface->triangles) {
    std::array<Vec3, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = surface->positions[corners[k]].cast<double>();
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

// The ground that --ground names. What is not level becomes triangles within 10 m of `centre`, to 1
// mm (terrain::surface_of()). Code ragdoll-ground if there is none within that.
Result<krok::ragdoll::Surroundings> surroundings_of(const GroundChoice& ground,
                                                    const Terrain& terrain, const Vec3& centre) {
  krok::ragdoll::Surroundings surroundings;
  if (ground.text == "level" || ground.text.starts_with("level:")) {
    surroundings.level = true;
    const auto point = terrain.at(centre.x(), centre.z());
    surroundings.height = point ? point->height : 0;
    return surroundings;
  }
  auto triangles = triangles_of(terrain, centre);
  if (!triangles) {
    return Error("ragdoll-ground", "there is no ground within 10 m of where the fall begins",
                 "krok-edit moves motions")
        .in_file(ground.text);
  }
  surroundings.triangles = *std::move(triangles);
  return surroundings;
}

constexpr double kTooFarBeyond = 45 * kRadiansPerDegree;

// A fall that is to be made, and where it is written.
struct Plan {
  std::string name, output;
  krok::ragdoll::FallOptions fall;
  Location place;  // of a table's row
};

class Run {
 public:
  Run(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<int> run();

 private:
  Status plan_falls();
  Status plan_table();
  Result<std::string> output_of(const std::string& file_name) const;
  Status begin_at(const ClipTime& at, const std::string& shown_time, Plan& plan);
  void check_ranges(std::span<const Transform> pose) const;
  Status add_push(const PushAt& push, Plan& plan) const;
  Status read_ground(Plan& plan);
  Status write(const Plan& plan, Provenance provenance, int jobs, Fallen& fallen,
               OutputFile& file) const;
  Status write_meshes(OutputFile& file) const;
  Status write_one();
  Result<int> write_all();
  void report_rows(const std::vector<std::optional<Error>>& failures,
                   const std::vector<std::vector<Error>>& faults);

  const Options& options_;
  ToolContext& context_;
  Subject subject_;
  std::vector<Plan> plans_;
};

Status Run::begin_at(const ClipTime& at, const std::string& shown_time, Plan& plan) {
  const Clip& clip = subject_.clip;
  plan.fall.at = at.seconds(clip.rate);
  if (plan.fall.at > clip.duration() + 1e-9) {
    return Error("ragdoll-time",
                 fmt::format("{} is after the motion's end, {} s", shown_time,
                             readable(clip.duration(), 4)),
                 frame_hint(at, clip.frame_count()))
        .in_file(options_.input);
  }
  const Status status =
      set_end(options_.follow, options_.duration, clip, subject_.roles, subject_.bodies, plan.fall);
  if (!status) return Error(status.error()).in_file(options_.input);
  plan.fall.joints.soft = options_.soft;
  plan.fall.rules = subject_.rules;
  if (options_.bodies.empty()) {
    // Through rules even if no file is written, so that a saved file gives the same fall.
    const auto pose = krok::ragdoll::pose_at(clip, plan.fall.at);
    plan.fall.rules = krok::ragdoll::rules_of(
        krok::ragdoll::make_joints(clip.skeleton, subject_.roles, subject_.bodies, subject_.limits,
                                   pose, plan.fall.joints),
        clip.skeleton, subject_.bodies, subject_.limits, pose);
    check_ranges(pose);
  }
  return {};
}

// Ranges give way to the pose that a fall begins in. One that is far off is not a person's, or the
// joint's role is another's.
void Run::check_ranges(std::span<const Transform> pose) const {
  const Skeleton& skeleton = subject_.clip.skeleton;
  int worst = -1;
  double most = kTooFarBeyond;
  for (const krok::ragdoll::Body& body : subject_.bodies) {
    const int joint = body.joint;
    if (subject_.limits.empty() || skeleton.parents[at(joint)] < 0) continue;
    const Quat& parent = pose[at(skeleton.parents[at(joint)])].orientation;
    const double beyond = krok::ik::excess(subject_.limits[at(joint)],
                                           parent.conjugate() * pose[at(joint)].orientation);
    if (beyond <= most) continue;
    most = beyond;
    worst = joint;
  }
  if (worst < 0) return;
  context_.warn(
      "ragdoll-range",
      fmt::format("where the fall begins, {} is {:.0f} degrees beyond its range, which is "
                  "widened to that",
                  shown(skeleton.names[at(worst)]), most / kRadiansPerDegree),
      "another --at; --map if krok-info -v shows a wrong role; or --limits from a file");
}

Status Run::add_push(const PushAt& push, Plan& plan) const {
  const Clip& clip = subject_.clip;
  const int joint = find_joint(clip.skeleton, subject_.roles, push.joint);
  if (joint < 0) {
    return Error("ragdoll-joint",
                 fmt::format("{}: the motion has no joint of that name or role", shown(push.joint)),
                 nearest_hint(push.joint, clip.skeleton.names))
        .in_file(options_.input);
  }
  const double time = push.timed ? push.time.seconds(clip.rate) : plan.fall.at;
  if (time < plan.fall.at - 1e-9 || time > plan.fall.at + plan.fall.duration) {
    return Error("ragdoll-time",
                 fmt::format("the push at {}: its time is not within the fall", shown(push.joint)),
                 "the fall is from its begin on, for --duration");
  }
  const auto carrier = krok::ragdoll::body_of_joint(clip.skeleton, subject_.bodies);
  plan.fall.pushes.push_back({std::max(0, carrier[at(joint)]), push.impulse, time});
  return {};
}

Status Run::read_ground(Plan& plan) {
  const Clip& clip = subject_.clip;
  const int frame = static_cast<int>(std::min(plan.fall.at * clip.rate, clip.frame_count() - 1.0));
  const int root = subject_.bodies.front().joint;
  const Vec3 centre = clip.frame_positions(frame)[at(root)].cast<double>();
  auto surroundings = surroundings_of(options_.ground, *subject_.terrain, centre);
  if (!surroundings) return surroundings.error();
  plan.fall.surroundings = std::move(*surroundings);
  plan.fall.world.friction = options_.friction;
  plan.fall.world.restitution = options_.restitution;
  return {};
}

Status Run::plan_falls() {
  if (!options_.push_table.empty()) return plan_table();
  Plan plan;
  plan.output = context_.output;
  if (Status status = begin_at(options_.at, "--at " + written(options_.at), plan); !status) {
    return status;
  }
  for (const PushAt& push : options_.pushes) {
    if (Status status = add_push(push, plan); !status) return status;
    constexpr double kSoon = 0.3;  // seconds
    const double after = plan.fall.pushes.back().time - plan.fall.at;
    if (after < kSoon || options_.follow.any()) continue;
    context_.warn("ragdoll-late-push",
                  fmt::format("the push at {} comes {} s after the body has gone limp",
                              shown(push.joint), readable(after, 3)),
                  fmt::format("--at {} lets the motion play until then, --powered 1 follows it",
                              written(push.time)));
  }
  if (Status status = read_ground(plan); !status) return status;
  plans_.push_back(std::move(plan));
  return {};
}

// The output of a row.
Result<std::string> Run::output_of(const std::string& file_name) const {
  std::string path = context_.output;
  std::error_code ignored;
  if (path.ends_with('/') || std::filesystem::is_directory(path, ignored)) {
    path += std::string(path.ends_with('/') ? "" : "/") + "{name}.anim";
  }
  const std::string_view mark = "{name}";
  const std::size_t found = path.rfind(mark);
  if (found == std::string::npos || path.find('/', found) != std::string::npos) {
    return Error("usage", fmt::format("-o {}: the falls of --pushes need distinct names", path),
                 "use {name} for the row's name: -o 'falls/{name}.anim'");
  }
  return path.replace(found, mark.size(), file_name);
}

Status Run::plan_table() {
  const auto file = context_.open_input(options_.push_table);
  if (!file) return file.error();
  const auto falls = read_push_table(file->text(), options_.push_table);
  if (!falls) return falls.error();
  for (const TableFall& fall : *falls) {
    const auto at_place = [&](Status status, Location place) {
      if (status) return status;
      place.file = options_.push_table;
      status.error().where = std::move(place);
      return status;
    };
    Plan plan;
    plan.name = fall.name;
    plan.place = fall.at_place;
    plan.place.file = options_.push_table;
    auto output = output_of(fall.file_name);
    if (!output) return output.error();
    plan.output = std::move(*output);
    Status status = at_place(begin_at(fall.at, "its begin", plan), fall.at_place);
    if (status) {
      status = add_push(fall.push, plan);
      const bool of_joint = !status && status.error().code == "ragdoll-joint";
      status = at_place(std::move(status), of_joint ? fall.joint_place : fall.time_place);
    }
    if (status) status = read_ground(plan);
    if (!status) return status;
    plans_.push_back(std::move(plan));
  }
  return {};
}

Status Run::write(const Plan& plan, Provenance provenance, int jobs, Fallen& fallen,
                  OutputFile& file) const {
  fallen.clip.provenance = std::move(provenance);
  auto& conversions = fallen.clip.provenance.conversions;
  conversions = subject_.clip.provenance.conversions;
  conversions.push_back("ragdoll: " + (plan.name.empty() ? "" : plan.name + ": ") +
                        summary_of(subject_, plan.fall, fallen));
  anim::WriteOptions writing;
  writing.orientation = options_.orientation;
  writing.jobs = jobs;
  return anim::write(fallen.clip, writing, file);
}

// The bodies as meshes on the skeleton's nodes.
Status Run::write_meshes(OutputFile& file) const {
  Clip still;
  still.skeleton = subject_.clip.skeleton;
  gltf::WriteOptions writing;
  writing.provenance = context_.provenance();
  writing.name = "bodies";
  return gltf::write_rig(krok::ragdoll::body_meshes(still.skeleton, subject_.bodies), still,
                         writing, file);
}

Status Run::write_one() {
  const Plan& plan = plans_.front();
  auto fallen = make_fall(subject_, plan.fall);
  if (!fallen) return std::move(fallen).error().in_file(options_.input);
  for (const Error& fault : faults_of(*fallen)) {
    context_.warn(fault.code, fault.message, fault.hint);
  }
  OutputSet outputs(context_);
  Status status = outputs.add(plan.output, [&](OutputFile& file) {
    return write(plan, context_.provenance(), context_.jobs, *fallen, file);
  });
  if (!status) return status;
  status = outputs.add(options_.save_bodies, [&](OutputFile& file) {
    if (extension(options_.save_bodies) == ".glb") return write_meshes(file);
    return file.write(
        ragdoll_file::write({subject_.bodies, plan.fall.rules}, subject_.clip.skeleton));
  });
  if (status) status = outputs.finish();
  if (!status) return status;
  context_.report.result = report_of(subject_, *fallen);
  context_.log(fmt::format("{}: {}", plan.output, summary_of(subject_, plan.fall, *fallen)));
  return {};
}

// A row that fails, as one that does not come to rest and so cannot get up, keeps none of the
// others from being written.
Result<int> Run::write_all() {
  std::vector<std::string> paths;
  for (const Plan& plan : plans_) paths.push_back(plan.output);
  std::vector<Json> rows(plans_.size());
  std::vector<std::vector<Error>> faults(plans_.size());
  std::vector<std::optional<Error>> failures(plans_.size());
  const Provenance provenance = context_.provenance();
  OutputSet outputs(context_);
  const auto make = [&](std::size_t i, OutputFile& file) -> Result<bool> {
    const Plan& plan = plans_[i];
    auto fallen = make_fall(subject_, plan.fall);
    rows[i] = {{"name", plan.name},
               {"status", fallen ? "done" : "failed"},
               {"output", fallen ? Json(plan.output) : Json()},
               {"start", plan.fall.at}};
    if (!fallen) {
      rows[i]["code"] = fallen.error().code;
      rows[i]["message"] = fallen.error().message;
      failures[i] = std::move(fallen).error();
      return false;
    }
    faults[i] = faults_of(*fallen);
    rows[i].update(report_of(subject_, *fallen));
    if (Status status = write(plan, provenance, 1, *fallen, file); !status) {
      return std::move(status).error();
    }
    return true;
  };
  Status status = outputs.add_some(paths, context_.jobs, make);
  if (status) status = outputs.finish();
  if (!status) return std::move(status).error();
  report_rows(failures, faults);
  context_.report.result["falls"] = std::move(rows);
  const bool all = std::ranges::none_of(failures, &std::optional<Error>::has_value);
  return all ? kExitDone : kExitPartly;
}

// Of each row what failed, or which tolerances it misses.
void Run::report_rows(const std::vector<std::optional<Error>>& failures,
                      const std::vector<std::vector<Error>>& faults) {
  std::size_t failed = 0, kept = 0;
  for (std::size_t i = 0; i < failures.size(); ++i) {
    const std::string name = fmt::format("the fall '{}': ", shown(plans_[i].name));
    if (failures[i]) {
      ++failed;
      Error error = *failures[i];
      error.message = name + error.message;
      error.where = plans_[i].place;
      context_.diagnose(std::move(error));
      continue;
    }
    kept += faults[i].empty() ? 1U : 0U;
    for (const Error& fault : faults[i]) {
      context_.warn(fault.code, name + fault.message, fault.hint);
    }
  }
  context_.log(fmt::format("{}: {} falls, {} of them within all tolerances{}", options_.push_table,
                           failures.size() - failed, kept,
                           failed > 0 ? fmt::format(", {} failed", failed) : ""));
}

Result<int> Run::run() {
  auto subject = read_subject(options_, context_);
  if (!subject) return subject.error();
  subject_ = std::move(*subject);
  if (Status status = plan_falls(); !status) return status.error();
  if (!options_.push_table.empty()) return write_all();
  if (const Status status = write_one(); !status) return status.error();
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  return Run(options, context).run();
}

}  // namespace krok::cli::ragdoll
