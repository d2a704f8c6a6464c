#include "tools/krok-fit/corrective_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/file.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "correctives/fit_correctives.h"
#include "formats/correctives/correctives_format.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/obj/obj_reader.h"
#include "formats/registry/registry.h"
#include "skin/bind.h"
#include "skin/surface_normals.h"
#include "skin/twist_joints.h"
#include "tools/cli/output_set.h"
#include "tools/cli/usage.h"

namespace krok::cli::fit {

namespace {

class PosesReader {
 public:
  PosesReader(std::string path, ToolContext& context) : path_(std::move(path)), context_(context) {}

  Result<CorrectiveFit> fit(const Options& options) {
    const auto file = context_.open_input(path_);
    if (!file) return file.error();
    auto description = corrective_poses::read(file->text());
    if (!description) return std::move(description.error()).in_file(path_);
    if (Status status = read_model(*description); !status) return status.error();
    std::vector<SculptedJoint> joints;
    for (const auto& entry : description->joints) {
      SculptedJoint joint;
      for (auto [from, to] : {std::pair(&entry.examples, &joint.examples),
                              std::pair(&entry.held_out, &joint.held_out)}) {
        for (const corrective_poses::Pose& pose : *from) {
          if (Status status = add(pose, *to); !status) return status.error();
        }
      }
      joint.joint = model_.skeleton.find(entry.joint);
      if (joint.joint < 0) {
        return at(entry.place, Error("fit-pose", fmt::format("the model has no joint '{}'",
                                                             shown(entry.joint))));
      }
      joints.push_back(std::move(joint));
    }
    CorrectiveFitOptions how;
    how.refine = options.refine.value_or(0);
    how.max_error = options.until.value_or(0);
    how.jobs = context_.jobs;
    auto made = fit_correctives(model_, description->method, joints, how);
    if (!made) return std::move(made.error()).in_file(path_);
    return made;
  }

 private:
  Error at(const Location& place, Error error) const {
    error.where = place;
    return std::move(error).in_file(path_);
  }

  Result<std::string> path_of(const std::string& name, const Location& place) const {
    auto path = path_inside(folder_of(path_), name);
    if (!path) return at(place, path.error());
    return path;
  }

  Result<Model> read_mesh(const std::string& name, const Location& place) {
    const auto path = path_of(name, place);
    if (!path) return path.error();
    const auto file = context_.open_input(*path);
    if (!file) return file.error();
    const bool obj = extension(*path) == ".obj" &&
                     registry::identify(*path, file->bytes()) == registry::Kind::unknown;
    Model model;
    if (obj) {
      auto shape = obj::read(file->text(), *path);
      if (!shape) return shape.error();
      context_.diagnose_in(*path, shape->diagnostics);
      model = std::move(shape->model);
    } else {
      auto actor =
          io::open_actor(*file, context_, {.with_materials = false, .with_motions = false});
      if (!actor) return actor.error();
      model = std::move(actor->model);
    }
    if (!model.triangles.empty()) return model;
    return Error("fit-pose", "the file has no mesh").in_file(*path);
  }

  Status read_model(const corrective_poses::Description& description) {
    auto model = read_mesh(description.model, {});
    if (!model) return model.error();
    model_ = *std::move(model);
    const corrective_poses::Pose& first = description.joints.front().examples.front();
    const auto clip = motion(first);
    if (!clip) return clip.error();
    auto bound = bind_to(std::move(model_), (*clip)->skeleton);
    if (!bound) return at(first.place, bound.error());
    model_ = *std::move(bound);
    return {};
  }

  // A motion, read once.
  Result<const Clip*> motion(const corrective_poses::Pose& pose) {
    const auto known = motions_.find(pose.motion);
    if (known != motions_.end()) return &known->second;
    const auto path = path_of(pose.motion, pose.place);
    if (!path) return path.error();
    auto clip = io::open_motion(*path, context_, {.rest_frame_is_note = true});
    if (!clip) return clip.error();
    Stretches none;
    carry_twist_joints(model_.skeleton, *clip, none);
    return &motions_.emplace(pose.motion, *std::move(clip)).first->second;
  }

  Status add(const corrective_poses::Pose& entry, std::vector<SculptedPose>& poses) {
    const auto clip = motion(entry);
    if (!clip) return clip.error();
    if (entry.frame >= (*clip)->frame_count()) {
      return at(entry.place, Error("fit-pose", fmt::format("{} has no frame {}, only 0 to {}",
                                                           shown(entry.motion), entry.frame,
                                                           (*clip)->frame_count() - 1)));
    }
    const std::string other = difference_in_structure(model_.skeleton, (*clip)->skeleton);
    if (!other.empty()) {
      return at(entry.place, Error("fit-pose", fmt::format("the skeleton of {} is another one: {}",
                                                           shown(entry.motion), other)));
    }
    auto mesh = read_mesh(entry.shape, entry.place);
    if (!mesh) return mesh.error();
    if (mesh->vertex_count() != model_.vertex_count()) {
      return at(entry.place,
                Error("correctives-vertices",
                      fmt::format("{} has {}, but the model has {}", shown(entry.shape),
                                  counted(mesh->vertex_count(), "vertex", "vertices"),
                                  grouped(model_.vertex_count())),
                      "shapes need the model's vertices in the model's order"));
    }
    SculptedPose& pose = poses.emplace_back();
    pose.name = fmt::format("{} (frame {} of {})", entry.shape, entry.frame, entry.motion);
    pose.joint_to_world.resize(model_.skeleton.names.size());
    (*clip)->get_pose(entry.frame, pose.joint_to_world);
    pose.positions = std::move(mesh->positions);
    pose.normals = std::move(mesh->normals);
    if (pose.normals.empty() && !model_.normals.empty()) {
      pose.normals.resize(pose.positions.size());
      moved_normals(model_.triangles, model_.positions, model_.normals, pose.positions,
                    pose.normals);
    }
    return {};
  }

  const std::string path_;
  ToolContext& context_;
  Model model_;
  std::map<std::string, Clip> motions_;
};

Json error_json(const SculptError& error) {
  Json json;
  json["root_mean_square"] = error.root_mean_square;
  json["largest"] = error.largest;
  json["vertex"] = error.vertex;
  return json;
}

// The errors of a joint's examples or held-out poses.
struct Group {
  int count = 0;
  double skinned = 0, corrected = 0;  // mean of root mean squares
  const PoseError* worst = nullptr;

  Group(const std::vector<PoseError>& errors, bool held_out) {
    for (const PoseError& error : errors) {
      if (error.held_out != held_out) continue;
      ++count;
      skinned += error.skinned.root_mean_square;
      corrected += error.corrected.root_mean_square;
      if (worst == nullptr || error.corrected.largest > worst->corrected.largest) worst = &error;
    }
    skinned /= std::max(1, count);
    corrected /= std::max(1, count);
  }

  double share() const { return skinned > 0 ? corrected / skinned : 0; }
  Json json() const {
    Json json;
    json["poses"] = count;
    json["skinned"] = skinned;
    json["corrected"] = corrected;
    json["share"] = share();
    json["worst"] = worst == nullptr ? Json() : Json(worst->name);
    return json;
  }
};

Json joint_json(const JointCorrective& joint, const std::vector<PoseError>& errors, int refined) {
  Json json;
  json["joint"] = joint.joint;
  json["targets"] = joint.target_count();
  json["parameters"] = joint.directions.size();
  json["squares"] = joint.squares;
  json["vertices"] = joint.vertices.size();
  json["refined"] = refined;
  json["examples"] = Group(errors, false).json();
  json["held_out"] = Group(errors, true).json();
  json["poses"] = Json::array();
  for (const PoseError& error : errors) {
    Json pose;
    pose["name"] = error.name;
    pose["held_out"] = error.held_out;
    pose["rotation"] = {error.rotation.x(), error.rotation.y(), error.rotation.z()};
    pose["skinned"] = error_json(error.skinned);
    pose["corrected"] = error_json(error.corrected);
    json["poses"].push_back(std::move(pose));
  }
  return json;
}

constexpr double kFarSculpt = 0.3;  // metres: more than muscles and folds of skin move

void log_joint(const JointCorrective& joint, const std::vector<PoseError>& errors, int refined,
               ToolContext& context) {
  const auto mm = [](double metres) { return readable(metres * 1e3, 3); };
  std::string text = fmt::format("{}: {}", joint.joint, counted(joint.target_count(), "target"));
  if (refined > 0) text += fmt::format(" ({} of them by refinement)", refined);
  text += fmt::format(" of {}", counted(joint.vertices.size(), "vertex", "vertices"));
  const Group held_out(errors, true);
  const Group group = held_out.count > 0 ? held_out : Group(errors, false);
  text += fmt::format(
      "; {}: {} mm to the sculpt, {} % of the {} mm without; largest {} mm in {}, "
      "vertex {}",
      held_out.count > 0 ? counted(held_out.count, "held-out pose") : "examples",
      mm(group.corrected), readable(100 * group.share(), 3), mm(group.skinned),
      mm(group.worst->corrected.largest), group.worst->name, group.worst->corrected.vertex);
  context.log(text);
  for (const PoseError& error : errors) {
    if (error.skinned.largest < kFarSculpt) continue;
    context.warn("fit-sculpt",
                 fmt::format("{}: the sculpt of {} is up to {} m from the skinned mesh",
                             joint.joint, error.name, readable(error.skinned.largest, 3)),
                 "a shape is in metres, and where its pose stands");
    break;
  }
  if (held_out.count > 0 && group.corrected > group.skinned) {
    context.warn("fit-worse",
                 fmt::format("{}: held-out poses are further from their sculpts than without "
                             "correctives",
                             joint.joint),
                 "give examples nearer to them, or --refine");
  }
}

}  // namespace

bool describes_poses(const std::string& path) {
  if (path == "-") return false;
  const auto file = InputFile::open(path);
  return file &&
         file->text().substr(0, 65536).find(corrective_poses::kSchema) != std::string_view::npos;
}

Result<int> run_correctives(const Options& options, ToolContext& context) {
  if (options.kernel || options.smooth || !options.resume.empty() || !options.plots.empty()) {
    return usage("--kernel, --smoothing, --resume and --plot are for step libraries",
                 "correctives are cubic splines; their errors are in the report, --json=FILE");
  }
  const std::string ending = extension(context.output);
  if (!ending.empty() && ending != ".correctives") {
    return usage(fmt::format("the output is a .correctives file, not {}", shown(context.output)));
  }
  const auto fit = PosesReader(options.first(), context).fit(options);
  if (!fit) return fit.error();
  const auto text = correctives_file::write(fit->correctives);
  if (!text) return text.error();
  Status status = write_output(context, context.output, *text);
  if (!status) return status.error();
  Json joints = Json::array();
  for (std::size_t j = 0; j < fit->errors.size(); ++j) {
    const JointCorrective& joint = fit->correctives.joints[j];
    joints.push_back(joint_json(joint, fit->errors[j], fit->refined[j]));
    log_joint(joint, fit->errors[j], fit->refined[j], context);
  }
  context.report.result = Json::object();
  context.report.result["joints"] = std::move(joints);
  return kExitDone;
}

}  // namespace krok::cli::fit
