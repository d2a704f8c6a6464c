#include "tools/krok-skin/subject.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"
#include "correctives/correctives.h"
#include "formats/correctives/correctives_format.h"
#include "formats/goals/goals.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/obj/obj_reader.h"
#include "formats/weights/weights.h"
#include "motion/sample.h"
#include "retarget/limb_ends.h"
#include "retarget/retarget.h"
#include "roles/roles.h"
#include "skin/bind.h"
#include "skin/twist_joints.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/retarget_outcome.h"

namespace krok::cli::skin {

namespace {

constexpr double kStillRate = 30.0;  // frames per second, if neither motion nor weights have a rate

class Loader {
 public:
  Loader(Options& options, ToolContext& context, const LongTake* take)
      : options_(options), context_(context), take_(take) {}

  Result<Subject> load() {
    for (const auto step : {&Loader::read_subject, &Loader::read_morphs, &Loader::read_weights,
                            &Loader::read_clip, &Loader::take_weights, &Loader::take_part,
                            &Loader::read_others, &Loader::add_correctives, &Loader::read_things}) {
      if (Status status = (this->*step)(); !status) return status.error();
    }
    return std::move(subject_);
  }

 private:
  Status read_subject() {
    std::error_code unknown;
    if (std::filesystem::is_directory(options_.subject, unknown)) {
      return usage(fmt::format("{} is a folder, not a mesh", shown(options_.subject)),
                   "a mesh comes first, then motions: krok-skin hero.character FOLDER -o hero.glb");
    }
    std::optional<InputFile> opened;
    if (take_ == nullptr) {
      auto input = context_.open_input(options_.subject);
      if (!input) return input.error();
      opened = *std::move(input);
    }
    const InputFile& file = opened ? *opened : take_->subject;
    const io::Format& format = io::format_of(file);
    if (format.read_actor == nullptr && format.read_scene == nullptr) {
      Error error = model::read(file.bytes()).error();
      if (!options_.motions.empty() && format.reads_motion()) {
        error.hint = "the mesh comes first, then motions; krok-body makes a mesh for a motion";
      }
      return std::move(error).in_file(options_.subject);
    }
    auto actor = io::open_actor(file, context_,
                                {.with_morphs = true,
                                 .with_motions = false,
                                 .stays_still = options_.motions.empty(),
                                 .keeps_mesh_alone = true});
    if (!actor) return actor.error();
    subject_.model = std::move(actor->model);
    subject_.materials = std::move(actor->materials);
    subject_.unnamed_is_none =
        format.kind == registry::Kind::glb || format.kind == registry::Kind::gltf;
    subject_.eyes = std::move(actor->eyes);
    subject_.sockets = std::move(actor->sockets);
    subject_.morphs = std::move(actor->morphs);
    rest_weights_ = std::move(actor->rest_weights);
    context_.diagnose_in(options_.subject, reference_pose_faults(subject_.model));
    if (options_.retarget) prepare_retargeting();
    if (Status status = add_twist_joints(options_.twist, subject_.model); !status) {
      return std::move(status.error()).in_file(options_.subject);
    }
    if (!subject_.model.triangles.empty()) return {};
    return Error("skin-empty-model", "the model has no triangles",
                 "create a model with a mesh with krok-body")
        .in_file(options_.subject);
  }

  Status read_morphs() {
    if (options_.morphs.empty()) return {};
    const auto file = context_.open_input(options_.morphs);
    if (!file) return file.error();
    auto morphs = morph_exr::read(file->bytes());
    if (!morphs) return std::move(morphs.error()).in_file(options_.morphs);
    if (morphs->vertex_count != subject_.model.vertex_count()) {
      return Error("skin-morphs",
                   fmt::format("the targets are for a mesh with {}, but the model has {}",
                               counted(morphs->vertex_count, "vertex", "vertices"),
                               subject_.model.vertex_count()),
                   "write both from one file with krok-import --save-model --save-morphs")
          .in_file(options_.morphs);
    }
    subject_.morphs = std::move(*morphs);
    return {};
  }

  Status read_weights() {
    const std::size_t motion = 0;
    auto weights = weights_of(motion);
    if (!weights) return weights.error();
    weights_ = *std::move(weights);
    return {};
  }

  // Those of a motion, from the file of --weights, whose {clip} is the motion's path without its
  // ending. Targets that it does not have keep the character's default weights.
  Result<std::optional<weights::WeightFile>> weights_of(std::size_t motion) {
    std::optional<weights::WeightFile> result;
    std::string path = options_.weights;
    if (const std::size_t place = path.find(kClipInName); place != std::string::npos) {
      const std::string& clip = options_.motions.at(motion);
      path.replace(place, kClipInName.size(), clip.substr(0, clip.size() - extension(clip).size()));
    }
    if (!path.empty()) {
      const auto file = context_.open_input(path);
      if (!file) return file.error();
      auto weights = weights::read(file->text(), path, subject_.morphs.names);
      if (!weights) return weights.error();
      if (auto warning = weights::implausible_weight(weights->curves)) {
        context_.diagnose_in(path, {*std::move(warning)});
      }
      result = std::move(*weights);
    }
    for (std::size_t t = 0; t < rest_weights_.size(); ++t) {
      if (rest_weights_[t] == 0.0f) continue;
      if (!result) {
        result.emplace();
        result->curves.names = subject_.morphs.names;
        result->curves.curves.resize(subject_.morphs.names.size());
      }
      MorphCurve& curve = result->curves.curves[t];
      if (curve.times.empty()) curve = {{0.0}, {static_cast<double>(rest_weights_[t])}, {}};
    }
    return result;
  }

  Status read_clip() {
    Clip& clip = subject_.clip;
    if (options_.motions.empty()) {
      clip.skeleton = subject_.model.skeleton;
      clip.rate = weights_ && weights_->rate ? *weights_->rate : kStillRate;
      clip.resize(1);
      clip.set_pose(0, clip.skeleton.reference);
      return {};
    }
    context_.progress->begin(options_.retarget ? "moving motions to the mesh" : "reading motions",
                             options_.motions.size());
    // With --keep-going the first that can be used.
    for (Status status = read_first(); !status; status = read_first()) {
      status = leave_out(0, std::move(status).error());
      if (!status) return status;
    }
    return {};
  }

  Status read_first() {
    Clip& clip = subject_.clip;
    const std::string& path = options_.motions.front();
    auto read = take_ != nullptr ? take_->clip : open(path, subject_.stretches, face_);
    if (!read) return read.error();
    clip = std::move(*read);
    if (take_ != nullptr) subject_.frames = take_->frames;
    carry_twist_joints(subject_.model.skeleton, clip, subject_.stretches);
    auto bound =
        bind_to(context_.keep_going ? subject_.model : std::move(subject_.model), clip.skeleton);
    if (!bound) return std::move(bound.error()).in_file(path);
    subject_.model = std::move(*bound);
    subject_.clip_name = names_.make(clip_name(0));
    const auto is_removed = [&](const auto& one) {
      return subject_.model.skeleton.find(one.joint) < 0;
    };
    std::erase_if(subject_.eyes, is_removed);
    std::erase_if(subject_.sockets, is_removed);
    if (!subject_.frames) {
      report_differences(clip, path);
      return {};
    }
    const auto found =
        reference_differences(subject_.model.skeleton, *subject_.frames, context_.jobs);
    if (!found) return found.error();
    context_.diagnose_in(path, *found);
    return {};
  }

  // Opens a motion; with --retarget, of the mesh's skeleton as it was read. Gets the weights of the
  // mesh's targets, none if the motion moves none of them.
  Result<Clip> open(const std::string& path, Stretches& stretches, MorphWeights& face) {
    const bool wants_face = !subject_.morphs.names.empty() && options_.weights.empty();
    auto clip = [&] {
      const HiddenProgress hidden(context_);
      return io::open_motion(path, context_,
                             {.weights = wants_face ? &face : nullptr, .stretches = &stretches});
    }();
    face = weights_of_targets(face, subject_.morphs.names, rest_weights_);
    context_.progress->advance(1);
    if (!clip || !options_.retarget) return clip;
    const RoleMap roles = find_roles(clip->skeleton);
    auto moved = krok::retarget::transfer(*clip, roles, target_, target_roles_, how_);
    if (!moved) {
      // No motion goes onto such a mesh.
      const bool of_mesh = roles.humanoid && !target_roles_.humanoid;
      return std::move(moved).error().in_file(of_mesh ? options_.subject : path);
    }
    const Outcome outcome{clip->skeleton, roles, target_.skeleton, target_roles_, moved->report};
    context_.diagnose_in(path, choices_of(outcome, false));
    if (context_.verbose) context_.log(fmt::format("{}: {}", path, summary(outcome)));
    stretches.clear();
    auto& removed = moved->clip.provenance.removed_root_motion;
    removed = clip->provenance.removed_root_motion;
    if (removed) removed->velocity *= moved->report.path_scale;
    return krok::retarget::without_last_joints(std::move(moved->clip),
                                               target_.skeleton.joint_count() - limbs_end_at_);
  }

  void prepare_retargeting() {
    target_.skeleton = krok::retarget::with_limb_ends(subject_.model);
    limbs_end_at_ = subject_.model.skeleton.joint_count();
    target_roles_ = find_roles(target_.skeleton);
    how_.target_floor = floor_below(subject_.model.positions, target_.skeleton, target_roles_);
    if (how_.target_floor) {
      how_.target_feet =
          krok::retarget::points_of_feet(subject_.model, target_.skeleton, target_roles_);
    }
    how_.jobs = context_.jobs;
  }

  Status leave_out(std::size_t motion, Error error) {
    const bool of_mesh = error.where.file == options_.subject;
    Status status = of_mesh ? Status(std::move(error))
                            : context_.leave_out(options_.motions[motion], std::move(error),
                                                 options_.motions.size());
    if (!status) return status;
    const auto place = static_cast<std::ptrdiff_t>(motion);
    options_.motions.erase(options_.motions.begin() + place);
    options_.clip_names.erase(options_.clip_names.begin() + place);
    return {};
  }

  // The further motions, which must be of the first one's skeleton.
  Status read_others() {
    for (std::size_t i = 1; i < options_.motions.size();) {
      Status status = read_other(i);
      if (status) {
        ++i;
      } else if (status = leave_out(i, std::move(status).error()); !status) {
        return status;
      }
    }
    context_.progress->end();
    return {};
  }

  Status read_other(std::size_t i) {
    const std::string& path = options_.motions[i];
    Stretches stretches;
    MorphWeights face;
    auto clip = open(path, stretches, face);
    if (!clip) return clip.error();
    carry_twist_joints(subject_.model.skeleton, *clip, stretches);
    const std::string difference = difference_in_structure(subject_.model.skeleton, clip->skeleton);
    if (!difference.empty()) {
      return Error("skin-motions",
                   fmt::format("its skeleton is not that of {}: {}",
                               base_name(options_.motions.front()), difference),
                   "--retarget puts motions on the skeleton of the mesh")
          .in_file(path);
    }
    report_differences(*clip, path);
    if (options_.every > 1 && clip->frame_count() > 0) {
      const int last = clip->frame_count() - 1;
      stretches = cut(stretches, clip->joint_count(), 0, last, options_.every);
      *clip = cut(*clip, 0, last, options_.every);
      face = cut(face, 0, last, options_.every);
    }
    if (face.values.empty() && !face_.values.empty()) {
      face = {clip->rate, face_.names, rest_weights_};
      face.values.resize(face.names.size());
    }
    Subject::Motion other{names_.make(clip_name(i)), std::move(*clip), std::move(stretches),
                          std::move(face)};
    if (!options_.clip_names[i].empty() && other.name != options_.clip_names[i]) {
      context_.warn("skin-name", fmt::format("another clip is named {}; that of {} is {}",
                                             shown(options_.clip_names[i]),
                                             base_name(options_.motions[i]), other.name));
    }
    if (options_.has_weights_by_clip()) {
      const auto weights = weights_of(i);
      if (!weights) return weights.error();
      if (*weights && other.clip.frame_count() > 0) {
        auto sampled = sample((*weights)->curves, other.clip.rate, other.clip.frame_count());
        if (!sampled) return Error(sampled.error()).in_file(path);
        other.weights = *std::move(sampled);
      }
    }
    subject_.others.push_back(std::move(other));
    return {};
  }

  // Appends the targets of --correctives to the morph targets, and their weights at each frame.
  Status add_correctives() {
    const std::string& path = options_.correctives;
    if (path.empty()) return {};
    const auto file = context_.open_input(path);
    if (!file) return file.error();
    auto correctives = correctives_file::read(file->text());
    if (!correctives) {
      Error error = std::move(correctives).error();
      if (error.code == "json-syntax" && error.hint.empty()) {
        error.hint = "krok-fit writes .correctives; morph targets (.exr) are given with --morph";
      }
      return std::move(error).in_file(path);
    }
    if (correctives->vertex_count != subject_.model.vertex_count()) {
      return Error("skin-correctives",
                   fmt::format("they are for a mesh with {}, but the model has {}",
                               counted(correctives->vertex_count, "vertex", "vertices"),
                               subject_.model.vertex_count()),
                   "fit them to this model with krok-fit")
          .in_file(path);
    }
    const bool linear = what_to_write(options_, context_.output) == As::rig;
    if (correctives->method != (linear ? SkinMethod::linear : options_.method)) {
      context_.diagnose_in(
          path,
          {make_warning(
              "skin-correctives-method",
              "they were fitted to another skinning method, whose faults they correct instead",
              linear ? "rigs are skinned by the viewer, with linear blend skinning"
                     : "use the --method that the description of the correctives has")});
    }
    const auto weights = CorrectiveWeights::create(*correctives, subject_.model.skeleton);
    if (!weights) return Error(weights.error()).in_file(path);
    MorphSet targets = targets_of(*correctives, subject_.model);
    UniqueNames names;
    for (const std::string& name : subject_.morphs.names) names.claim(name);
    for (std::string& name : targets.names) name = names.make(name);
    append(targets);
    const MorphWeights own = std::move(subject_.weights);
    subject_.weights = with_correctives(own, subject_.clip, *weights);
    for (Subject::Motion& other : subject_.others) {
      other.weights = with_correctives(other.weights.values.empty() ? own : other.weights,
                                       other.clip, *weights);
    }
    return {};
  }

  // Appends morph targets; all have normals if the model has.
  void append(const MorphSet& targets) {
    MorphSet& morphs = subject_.morphs;
    const std::vector<Vec3f>& normals = subject_.model.normals;
    if (normals.empty()) morphs.normals.clear();
    while (morphs.normals.size() < morphs.positions.size() && !normals.empty()) {
      morphs.normals.insert(morphs.normals.end(), normals.begin(), normals.end());
    }
    morphs.vertex_count = targets.vertex_count;
    const auto add = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    add(morphs.names, targets.names);
    add(morphs.positions, targets.positions);
    add(morphs.normals, targets.normals);
  }

  // Weights of the targets before, followed by those of the correctives at each frame.
  MorphWeights with_correctives(const MorphWeights& own, const Clip& clip,
                                const CorrectiveWeights& correctives) const {
    MorphWeights all{clip.rate, subject_.morphs.names, {}};
    const std::size_t targets = all.names.size(), added = correctives.target_count();
    all.values.resize(targets * static_cast<std::size_t>(clip.frame_count()));
    std::vector<Transform> joints(clip.skeleton.names.size());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const std::span row = std::span(all.values).subspan(frame * targets, targets);
      if (own.frame_count() > 0) {
        const auto from = std::min(frame, own.frame_count() - 1) * (targets - added);
        std::copy_n(own.values.begin() + static_cast<std::ptrdiff_t>(from), targets - added,
                    row.begin());
      }
      clip.get_pose(frame, joints);
      correctives.at(joints, row.last(added));
    }
    return all;
  }

  Status read_things() {
    for (const std::string& text : options_.attached) {
      const NamedPath given = named_path(text);
      if (given.name.empty()) {
        return usage(fmt::format("--attach '{}' names no joint or socket", shown(text)),
                     "write right_hand=cup.glb");
      }
      Subject::Thing thing{clip_name_of(given.path), 0, {}, {}};
      const auto socket = std::ranges::find(subject_.sockets, given.name, &Character::Socket::name);
      const Skeleton& skeleton = subject_.model.skeleton;
      if (socket != subject_.sockets.end()) {
        thing.socket = socket->name;
        thing.joint = skeleton.find(socket->joint);
      } else {
        thing.joint = find_joint(skeleton, find_roles(skeleton), given.name);
      }
      if (thing.joint < 0) {
        return Error("skin-attach",
                     fmt::format("--attach {}: there is no socket or joint of that name or role",
                                 shown(given.name)),
                     nearest_hint(given.name, places()))
            .in_file(options_.subject);
      }
      auto actor = open_thing(given.path);
      if (!actor) return actor.error();
      if (!actor->has_mesh()) {
        return Error("skin-attach", "has no mesh to attach").in_file(given.path);
      }
      thing.model = std::move(actor->model);
      warn_of_size(given, thing.model);
      take_materials(std::move(actor->materials), thing);
      subject_.things.push_back(std::move(thing));
    }
    return {};
  }

  // What --attach may name.
  std::vector<std::string> places() const {
    const Skeleton& skeleton = subject_.model.skeleton;
    std::vector<std::string> names = skeleton.names;
    const RoleMap roles = find_roles(skeleton);
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const Role role = roles.roles[static_cast<std::size_t>(j)];
      if (role == Role::none || role == Role::end || roles.joint(role) != j) continue;
      names.emplace_back(role_name(role));
    }
    for (const Character::Socket& socket : subject_.sockets) names.push_back(socket.name);
    return names;
  }

  Result<Actor> open_thing(const std::string& path) {
    if (extension(path) != ".obj") {
      return io::open_actor(path, context_, {.with_motions = false});
    }
    const auto file = context_.open_input(path);
    if (!file) return file.error();
    auto shape = obj::read(file->text(), path);
    if (!shape) return shape.error();
    context_.diagnose(shape->diagnostics);
    Actor actor;
    actor.model = std::move(shape->model);
    return actor;
  }

  // A thing in another unit, or modelled at its place in a scene instead of at its own origin.
  void warn_of_size(const NamedPath& given, const Model& thing) {
    constexpr double kLarge = 3, kSmall = 1e-3;  // of the body
    Eigen::AlignedBox3f body, box;
    for (const Vec3f& point : subject_.model.positions) body.extend(point);
    for (const Vec3f& point : thing.positions) box.extend(point);
    const auto size = static_cast<double>(box.sizes().maxCoeff());
    const auto usual = static_cast<double>(body.sizes().maxCoeff());
    const auto away = static_cast<double>(box.exteriorDistance(Vec3f(Vec3f::Zero())));
    const bool odd_size = size > kLarge * usual || size < kSmall * usual;
    if (!odd_size && away <= usual) return;
    const std::string body_size = fmt::format("the body is {} m in size", readable(usual, 3));
    context_.diagnose_in(
        given.path,
        {make_warning(
            "skin-attach",
            odd_size ? fmt::format("the mesh is {} m in size, {}", readable(size, 3), body_size)
                     : fmt::format("the mesh begins {} m from the place '{}' that carries it; {}",
                                   readable(away, 3), shown(given.name), body_size),
            odd_size ? "scale it where it was made: glTF and OBJ files are in metres"
                     : "move it to the origin of its file, which is the joint or socket")});
  }

  // Adds a thing's materials to the subject's, under names that are not taken.
  void take_materials(std::vector<Material> materials, Subject::Thing& thing) {
    const auto is_taken = [&](const std::string& name) {
      return find_material(subject_.materials, name) != nullptr ||
             std::ranges::any_of(subject_.model.parts,
                                 [&](const Model::Part& part) { return part.material == name; });
    };
    std::map<std::string, std::string> renamed;
    for (Material& material : materials) {
      std::string name = material.name;
      for (int i = 2; is_taken(name); ++i) name = fmt::format("{}_{}", material.name, i);
      renamed[material.name] = name;
      material.name = std::move(name);
      subject_.materials.push_back(std::move(material));
    }
    for (Model::Part& part : thing.model.parts) part.material = renamed[part.material];
  }

  std::string clip_name(std::size_t motion) const {
    const std::string& given = options_.clip_names[motion];
    return given.empty() ? clip_name_of(options_.motions[motion]) : given;
  }

  void report_differences(const Clip& clip, const std::string& path) {
    context_.diagnose_in(path, reference_differences(subject_.model.skeleton, clip));
  }

  // Samples the weights at the frames of the motion; a static pose is held for their duration.
  Status take_weights() {
    subject_.weights = face_;
    if (!weights_ || !face_.values.empty()) return {};
    Clip& clip = subject_.clip;
    const auto needed = frames_of(weights_->curves, clip.rate);
    if (!needed) return Error(needed.error()).in_file(options_.weights);
    if (clip.frame_count() == 1 && *needed > 1) {
      clip = hold(clip, *needed);
      const Stretches still = subject_.stretches;
      for (int frame = 1; frame < *needed; ++frame) {
        subject_.stretches.insert(subject_.stretches.end(), still.begin(), still.end());
      }
    } else if (const double over = weights_->curves.duration() - subject_.duration();
               over > 1 / clip.rate) {
      context_.diagnose(
          warning("skin-weights-longer",
                  fmt::format("the weights last {} s, the motion {} s; the rest is ignored",
                              readable(weights_->curves.duration()), readable(clip.duration()))));
    }
    // Those of several motions do not change, unless each has its own.
    const bool still = options_.motions.size() > 1 && !options_.has_weights_by_clip();
    const int frames = still ? 1 : std::max(1, subject_.frame_count());
    auto weights = sample(weights_->curves, clip.rate, frames);
    if (!weights) return Error(weights.error()).in_file(options_.weights);
    subject_.weights = std::move(*weights);
    return {};
  }

  Status take_part() {
    const auto range = chosen_range(options_, subject_.clip.rate, subject_.frame_count());
    if (!range) {
      return Error(range.error())
          .in_file(options_.motions.empty() ? options_.subject : options_.motions.front());
    }
    if (!*range) return {};
    const auto [first, last, every] = **range;
    if (subject_.frames) {
      subject_.frames = part_of(*subject_.frames, first, last - first + 1);
    } else {
      subject_.clip = cut(subject_.clip, first, last, every);
    }
    subject_.stretches = cut(subject_.stretches, subject_.clip.joint_count(), first, last, every);
    subject_.first_frame = first;
    subject_.every = every;
    if (!subject_.changes_shape() || subject_.weights.frame_count() == 1) return {};
    subject_.weights = cut(subject_.weights, first, last, every);
    return {};
  }

  Diagnostic warning(std::string code, std::string message) const {
    Diagnostic diagnostic = make_warning(std::move(code), std::move(message));
    diagnostic.where.file = options_.weights;
    return diagnostic;
  }

  static Clip hold(const Clip& still, int frames) {
    Clip held = still;
    held.resize(frames);
    for (int frame = 1; frame < frames; ++frame) {
      std::ranges::copy(still.frame_positions(0), held.frame_positions(frame).begin());
      std::ranges::copy(still.frame_orientations(0), held.frame_orientations(frame).begin());
    }
    return held;
  }

  Options& options_;
  ToolContext& context_;
  const LongTake* take_;
  Subject subject_;
  std::vector<float> rest_weights_;  // [targets], for characters
  MorphWeights face_;                // of the first motion, where it moves targets
  std::optional<weights::WeightFile> weights_;
  UniqueNames names_;  // of the motions
  Clip target_;        // of --retarget: the mesh's skeleton, without frames
  RoleMap target_roles_;
  int limbs_end_at_ = 0;  // joints of target_ from here on are not the mesh's
  krok::retarget::Options how_;
};

}  // namespace

std::vector<Subject::NamedMotion> Subject::all_motions(const std::string& still_name) const {
  std::vector<NamedMotion> motions;
  if (!clip_name.empty() || weights.frame_count() > 1) {
    motions.push_back({clip_name.empty() ? still_name : clip_name, clip,
                       frames ? &*frames : nullptr, stretches, weights});
  }
  for (const Motion& other : others) {
    const bool own = !other.weights.values.empty();
    motions.push_back(
        {other.name, other.clip, nullptr, other.stretches, own ? other.weights : weights});
  }
  return motions;
}

Result<Subject> load(Options& options, ToolContext& context, const LongTake* take) {
  return Loader(options, context, take).load();
}

}  // namespace krok::cli::skin
