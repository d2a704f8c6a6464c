#include "tools/krok-import/scene_import.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "character/mesh.h"
#include "character/motion.h"
#include "character/space.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/cam/cam.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "tools/common/output_kind.h"
#include "tools/krok-import/clips.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/output_set.h"

namespace krok::import {

namespace {

using registry::Kind;

constexpr int kMostSamples = 200;  // moments that axes and unit are worked out from

Result<nodes::Scene> read_by_kind(const InputFile& input, Kind kind) {
  if (registry::is_read_through_assimp(kind)) {
    if (input.path() != "-") return assimp::read_file(input.path());
    return Error("assimp-kind",
                 "only BVH, Acclaim's formats and GLB can be read from standard input");
  }
  gltf::ReadOptions options;
  if (input.path() != "-") {
    const std::string folder = std::filesystem::path(input.path()).parent_path().string();
    options.folder = folder.empty() ? "." : folder;
  }
  return gltf::read(input.bytes(), options);
}

Result<nodes::Scene> read_scene(const InputFile& input, Kind kind, ToolContext& context) {
  auto scene = read_by_kind(input, kind);
  if (!scene) return std::move(scene.error()).in_file(input.path());
  // What else was read belongs to the report too.
  for (const std::string& path : scene->files) {
    if (path == input.path()) continue;
    if (const auto other = context.open_input(path); !other) return other.error();
  }
  return scene;
}

Status check_options(const Options& options) {
  const auto for_captures = [](const char* option) {
    return Error("usage", fmt::format("{} is for captures (BVH, AMC)", option));
  };
  if (!options.skeleton.empty()) return for_captures("--skeleton");
  if (options.positions != bvh::Positions::automatic) return for_captures("--positions");
  if (options.angles != bvh::Angles::degrees) return for_captures("--angles");
  if (options.rest_frame != bvh::RestFrame::keep) return for_captures("--skip-rest-frame");
  if (options.repair) return for_captures("--repair");
  return {};
}

// A scene on its way into Krok's form.
class Import {
 public:
  Import(const InputFile& input, const Options& options, const CaptureOptions& how,
         const nodes::Scene& scene, const nodes::Evaluator& evaluator, ToolContext& context)
      : path_(input.path()),
        options_(options),
        how_(how),
        context_(context),
        scene_(scene),
        evaluator_(evaluator),
        outputs_(context) {}

  Result<int> run() {
    for (auto step : {&Import::choose, &Import::find_rig, &Import::find_space, &Import::add_figure,
                      &Import::add_clips}) {
      if (Status done = (this->*step)(); !done) return std::move(done.error()).in_file(path_);
    }
    tell_what_else_is_there();
    const std::string written = outputs_.names();
    if (Status done = outputs_.finish(); !done) return done.error();
    report();
    context_.say(fmt::format("{} -> {}", line_, written));
    return kExitDone;
  }

 private:
  bool wants_motion() const { return !context_.output.empty(); }
  bool wants_model() const { return !options_.model.empty(); }
  bool wants_camera() const { return !options_.cam.empty(); }
  bool wants_morphs() const { return !options_.morphs.empty() || !options_.weights.empty(); }
  // Tells what the library found, as said of this file.
  void tell(Diagnostics& found) {
    for (Diagnostic& diagnostic : found) {
      diagnostic.where.file = path_;
      context_.tell(std::move(diagnostic));
    }
    found.clear();
  }
  void warn(const char* code, std::string message, std::string hint = {},
            Severity severity = Severity::warning) {
    Diagnostic told;
    told.severity = severity;
    told.code = code;
    told.message = std::move(message);
    told.hint = std::move(hint);
    told.where.file = path_;
    context_.tell(std::move(told));
  }
  Error missing(const std::string& what, const std::string& option, std::string hint) const {
    return Error("import-missing",
                 fmt::format("no {} is in it: {} cannot be written", what, option),
                 std::move(hint));
  }

  Status choose();
  Status choose_camera();
  Status find_rig();
  Status find_space();
  Status add_figure();
  Status add_model();
  Status add_morphs();
  Status add_weights(const ChosenClip& clip, const character::ChosenSampling& sampling);
  Status add_clips();
  Status add_clip(const ChosenClip& clip);
  Status add_camera(const ChosenClip& clip, const character::ChosenSampling& sampling);
  std::string label_of_camera(std::size_t index) const;
  void tell_what_else_is_there();
  void report();

  const std::string path_;
  const Options& options_;
  const CaptureOptions& how_;
  ToolContext& context_;
  const nodes::Scene& scene_;
  const nodes::Evaluator& evaluator_;
  OutputSet outputs_;

  std::vector<ChosenClip> clips_;
  std::vector<int> cameras_;  // nodes
  int camera_ = -1;           // the node that is written
  std::optional<character::Rig> rig_;
  character::Figure figure_;
  Conventions conventions_;
  Conversion conversion_;
  std::vector<std::string> conversions_;
  Json result_ = Json::object(), clip_facts_ = Json::array();
  std::string line_;
};

std::string Import::label_of_camera(std::size_t index) const {
  const nodes::Node& node = scene_.nodes[static_cast<std::size_t>(cameras_[index])];
  const std::string& lens = scene_.cameras[static_cast<std::size_t>(node.camera)].name;
  return fmt::format("{} ({})", index, shown(node.name.empty() ? lens : node.name));
}

Status Import::choose_camera() {
  if (cameras_.empty()) {
    return missing("camera", "--cam", "in glTF a camera must belong to a node of the scene");
  }
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(cameras_.size(), 20); ++i) {
    list += (i == 0 ? "" : ", ") + label_of_camera(i);
  }
  if (options_.camera.empty()) {
    camera_ = cameras_[0];
    if (cameras_.size() == 1) return {};
    warn("import-cameras",
         fmt::format("of {} cameras the first is taken; they are {}", cameras_.size(), list),
         "--camera takes another by its name or number");
    return {};
  }
  for (const int node : cameras_) {
    const nodes::Node& one = scene_.nodes[static_cast<std::size_t>(node)];
    if (one.name == options_.camera ||
        scene_.cameras[static_cast<std::size_t>(one.camera)].name == options_.camera) {
      camera_ = node;
      return {};
    }
  }
  const auto number = parse_integer(options_.camera);
  if (number && *number >= 0 && *number < static_cast<long long>(cameras_.size())) {
    camera_ = cameras_[static_cast<std::size_t>(*number)];
    return {};
  }
  return Error("import-camera", fmt::format("no camera is called {}", shown(options_.camera)),
               "it has " + list);
}

Status Import::choose() {
  cameras_ = character::camera_nodes(scene_, evaluator_);
  if (wants_camera()) {
    if (Status chosen = choose_camera(); !chosen) return chosen;
  }
  auto clips = choose_clips(scene_, options_.clip, path_, context_);
  if (!clips) return clips.error();
  clips_ = std::move(*clips);
  if (wants_motion() && clips_.empty()) {
    return missing("animation", "-o", "--model alone takes the character, --cam alone a camera");
  }
  return {};
}

Status Import::find_rig() {
  const bool known = scene_.space.metres && scene_.space.file_to_krok;
  const bool needed = wants_motion() || wants_model() || wants_morphs();
  if (!needed && known) return {};
  Diagnostics found;
  auto joints = character::choose_joints(scene_, evaluator_, options_.skin, found);
  if (!joints && !needed) return {};  // a camera alone can do without
  if (!joints) return joints.error();
  auto rig = character::make_rig(scene_, evaluator_, std::move(*joints), found);
  if (!rig) return rig.error();
  rig_ = std::move(*rig);
  if (needed) tell(found);
  return {};
}

Status Import::find_space() {
  std::vector<Vec3> samples;
  if (rig_ && !clips_.empty()) {
    Diagnostics ignored;
    const auto& animation = scene_.animations[static_cast<std::size_t>(clips_[0].animation)];
    const auto sampling = character::choose_sampling(animation, {}, ignored);
    if (!sampling) return sampling.error();
    samples = character::sample_positions(evaluator_, *rig_, clips_[0].animation,
                                          sampling->sampling, kMostSamples);
  }
  conventions_ = character::find_conventions(scene_.space, rig_ ? &*rig_ : nullptr, samples, how_);
  auto conversion = Conversion::make(conventions_);
  if (!conversion) return conversion.error();
  conversion_ = *conversion;
  conversions_ = describe_conversions(conventions_, how_);
  GivenConventions said = how_;  // by the user or the file
  if (scene_.space.metres) said.unit = conventions_.unit;
  if (scene_.space.file_to_krok) {
    said.up = conventions_.up;
    said.forward = conventions_.forward;
  }
  Diagnostics found;
  report_conventions(conventions_, said, "scene", path_, found);
  tell(found);
  if (!rig_) return {};
  auto skeleton = character::skeleton_in_krok(*rig_, conversion_);
  if (!skeleton) return skeleton.error();
  if (said.complete()) character::check_figure(*skeleton, found);
  tell(found);
  return {};
}

Status Import::add_figure() {
  if (!wants_model() && !wants_morphs()) return {};
  Diagnostics found;
  auto figure = character::make_figure(scene_, evaluator_, *rig_, conversion_,
                                       {.with_morphs = wants_morphs()}, found);
  if (!figure) return figure.error();
  tell(found);
  figure_ = std::move(*figure);
  if (Status added = add_model(); !added) return added;
  return wants_morphs() ? add_morphs() : Status();
}

Status Import::add_model() {
  if (!wants_model()) return {};
  Model& model = figure_.model;
  model.provenance = context_.provenance();
  model.provenance.conversions = conversions_;
  result_["model"] = {{"vertices", model.vertex_count()},
                      {"triangles", model.triangles.size()},
                      {"parts", model.parts.size()},
                      {"joints", model.skeleton.joint_count()}};
  line_ = fmt::format("{}: {}, {}, {}", base_name(path_),
                      counted(model.skeleton.joint_count(), "joint"),
                      counted(model.vertex_count(), "vertex", "vertices"),
                      counted(static_cast<long long>(model.triangles.size()), "triangle"));
  return outputs_.add(options_.model, [&](OutputFile& file) {
    return model::write(model, {.orientation = options_.orientation}, file);
  });
}

Status Import::add_morphs() {
  MorphSet& morphs = figure_.morphs;
  const char* option = options_.morphs.empty() ? "--morph-weights" : "--morphs";
  if (morphs.names.empty()) return missing("morph target", option, "");
  result_["morph_targets"] = morphs.names;
  morphs.provenance = context_.provenance();
  morphs.provenance.conversions = conversions_;
  if (line_.empty()) {
    line_ = fmt::format("{}: {} of {}", base_name(path_),
                        counted(morphs.target_count(), "morph target"),
                        counted(morphs.vertex_count, "vertex", "vertices"));
  }
  return outputs_.add(options_.morphs,
                      [&](OutputFile& file) { return morph_exr::write(morphs, file); });
}

Status Import::add_weights(const ChosenClip& clip, const character::ChosenSampling& sampling) {
  if (options_.weights.empty()) return {};
  const auto weights =
      character::make_weights(figure_, evaluator_, clip.animation, sampling.sampling);
  const auto path = clip_path(options_.weights, "--morph-weights", clip, clips_.size() > 1, ".csv");
  if (!path) return path.error();
  return outputs_.add(*path, [&](OutputFile& file) { return csv::write(weights, file); });
}

Status Import::add_clips() {
  if (clips_.empty()) {  // a camera that stands still
    const character::ChosenSampling still;
    if (Status added = add_weights({}, still); !added) return added;
    return wants_camera() ? add_camera({}, still) : Status();
  }
  if (!wants_motion() && !wants_camera() && options_.weights.empty()) return {};
  for (const ChosenClip& clip : clips_) {
    if (Status added = add_clip(clip); !added) return added;
  }
  return {};
}

Status Import::add_clip(const ChosenClip& chosen) {
  Diagnostics found;
  character::SamplingOptions wanted;
  wanted.source_rate = how_.rate;
  if (options_.resample > 0) wanted.rate = options_.resample;
  const auto& animation = scene_.animations[static_cast<std::size_t>(chosen.animation)];
  const auto sampling = character::choose_sampling(animation, wanted, found);
  if (!sampling) return sampling.error();
  Json facts = Json::object();
  facts["clip"] = {{"name", chosen.name}, {"number", chosen.animation}};
  if (wants_motion()) {
    if (!character::moves_rig(scene_, *rig_, chosen.animation)) {
      warn("import-still", fmt::format("{} moves no joint of the skeleton", shown(chosen.name)));
    }
    auto clip = character::make_clip(evaluator_, *rig_, conversion_, chosen.animation,
                                     sampling->sampling, context_.jobs, context_.progress, found);
    if (!clip) return clip.error();
    tell(found);
    clip->provenance = context_.provenance();
    clip->provenance.conversions = conversions_;
    clip->provenance.conversions.push_back(
        fmt::format("keys sampled at {} frames a second from {} s on",
                    readable(1 / sampling->sampling.step), readable(sampling->keys_from)));
    const auto path = clip_path(context_.output, "-o", chosen, clips_.size() > 1, ".anim");
    if (!path) return path.error();
    if (Status fits = check_output_kind(*path, "-o", Kind::anim); !fits) return fits;
    const Status added = outputs_.add(*path, [&](OutputFile& file) {
      return anim::write(*clip, {.orientation = options_.orientation, .jobs = context_.jobs}, file);
    });
    if (!added) return added;
    facts.update(facts_of(*clip));
    facts["output"] = *path;
    line_ = line_about(path_, *clip);
  }
  tell(found);
  facts["source_rate"] = to_json(sampling->rate);
  facts["keys"] = {{"from", sampling->keys_from}, {"to", sampling->keys_to}};
  clip_facts_.push_back(std::move(facts));
  if (Status added = add_weights(chosen, *sampling); !added) return added;
  return wants_camera() ? add_camera(chosen, *sampling) : Status();
}

Status Import::add_camera(const ChosenClip& clip, const character::ChosenSampling& sampling) {
  Diagnostics found;
  auto track = character::make_camera(scene_, evaluator_, camera_, conversion_,
                                      character::rotation_to_apply(scene_.space), clip.animation,
                                      sampling.sampling, found);
  if (!track) return track.error();
  tell(found);
  track->provenance = context_.provenance();
  track->provenance.conversions = conversions_;
  const auto path = clip_path(options_.cam, "--cam", clip, clips_.size() > 1, ".cam");
  if (!path) return path.error();
  if (Status fits = check_output_kind(*path, "--cam", Kind::cam); !fits) return fits;
  result_["camera"] = {
      {"name", scene_.nodes[static_cast<std::size_t>(camera_)].name},
      {"frames", track->frame_count()},
      {"rate", track->rate},
      {"field_of_view", static_cast<double>(track->fields_of_view.front()) / kRadiansPerDegree}};
  if (line_.empty()) {
    line_ = fmt::format("{}: camera {}, {} at {} /s", base_name(path_),
                        shown(scene_.nodes[static_cast<std::size_t>(camera_)].name),
                        counted(track->frame_count(), "frame"), readable(track->rate));
  }
  return outputs_.add(*path, [&](OutputFile& file) {
    return cam::write(*track, {.orientation = options_.orientation}, file);
  });
}

// What the file holds beyond what was asked for, so that nobody looks for it elsewhere.
void Import::tell_what_else_is_there() {
  std::vector<std::string> more;
  const auto has = [&](std::size_t count, const char* one, const char* option) {
    if (count > 0) {
      more.push_back(fmt::format("{} ({})", counted(static_cast<long long>(count), one), option));
    }
  };
  std::size_t targets = 0, meshes = 0;
  for (const nodes::Mesh& mesh : scene_.meshes) targets += mesh.target_count();
  if (!wants_model()) meshes = scene_.meshes.size();
  if (meshes > 0) more.push_back(meshes == 1 ? "a mesh (--model)" : "meshes (--model)");
  if (!wants_camera()) has(cameras_.size(), "camera", "--cam");
  if (!wants_morphs()) has(targets, "morph target", "--morphs");
  if (more.empty()) return;
  warn("import-more", fmt::format("the file also holds {}", fmt::join(more, ", ")), "",
       Severity::note);
}

void Import::report() {
  Json result = Json::object();
  // One clip's facts stand where those of a capture do.
  if (clip_facts_.size() == 1) result.update(clip_facts_[0]);
  result.update(facts_of(conventions_));
  if (clip_facts_.size() > 1) result["clips"] = clip_facts_;
  result["animations"] = Json::array();
  for (const nodes::Animation& one : scene_.animations) result["animations"].push_back(one.name);
  result.update(result_);
  result["repairs"] = Json::array();
  context_.report.result = std::move(result);
}

// With --strict what the reader warned of is a fault.
Status check_strict(const Options& options, const nodes::Scene& scene) {
  if (!options.strict) return {};
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    if (diagnostic.severity != Severity::warning) continue;
    Error error(diagnostic);
    error.severity = Severity::error;
    error.hint = "without --strict it is a warning";
    return error;
  }
  return {};
}

}  // namespace

bool is_scene(Kind kind) {
  return kind == Kind::glb || kind == Kind::gltf || registry::is_read_through_assimp(kind);
}

Result<int> import_scene(const InputFile& input, Kind kind, const Options& options,
                         ToolContext& context) {
  if (Status fits = check_options(options); !fits) return fits.error();
  auto how = read_options(options);
  if (!how) return how.error();
  auto scene = read_scene(input, kind, context);
  if (!scene) return scene.error();
  if (Status fits = check_strict(options, *scene); !fits) {
    return std::move(fits.error()).in_file(input.path());
  }
  for (Diagnostic& diagnostic : scene->diagnostics) diagnostic.where.file = input.path();
  context.tell(scene->diagnostics);
  // Axes that the user names take the place of an odd rotation that the file names.
  if ((how->up || how->forward) && character::rotation_to_apply(scene->space) != Mat4::Identity()) {
    scene->space.file_to_krok.reset();
  }
  auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return std::move(evaluator.error()).in_file(input.path());
  return Import(input, options, *how, *scene, *evaluator, context).run();
}

}  // namespace krok::import
