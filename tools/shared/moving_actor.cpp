#include "tools/shared/moving_actor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "body/body.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "motion/ground_frame.h"
#include "nodes/evaluate.h"
#include "tools/cli/file_name.h"
#include "tools/shared/animation_choice.h"
#include "tools/shared/bone_actor.h"
#include "tools/shared/drawn_body.h"

namespace krok::cli {

namespace {

using registry::Kind;

// The body of a motion: a mesh or none, with materials if from a character.
struct Body {
  std::shared_ptr<const Model> model;
  std::vector<Material> materials;
};

// A clip with its body, if any, prepared for drawing at any time.
class ClipActor {
 public:
  ClipActor(Clip clip, const Body& body, SkinMethod method, const DecodedImages& images)
      : clip_(std::move(clip)),
        style_(bone_style(clip_.skeleton)),
        carrier_(carrying_joint(find_roles(clip_.skeleton))) {
    if (body.model != nullptr) body_.emplace(body.model, body.materials, method, images);
  }

  render::Actor at(double time) const {
    const auto pose = pose_at(time);
    render::Actor actor;
    if (body_) {
      actor.surfaces = body_->at(pose);
    } else {
      std::vector<Vec3f> positions;
      positions.reserve(pose.size());
      for (const Transform& joint : pose) positions.push_back(joint.position.cast<float>());
      actor = bone_actor(style_, positions);
    }
    const Vec3& place = pose[static_cast<std::size_t>(carrier_)].position;
    actor.centre = Vec3(place.x(), 0, place.z());
    return actor;
  }

  Vec3 carrier(double time) const {
    return pose_at(time)[static_cast<std::size_t>(carrier_)].position;
  }

  double heading(double time) const {
    const auto pose = pose_at(time);
    return ground_frame(clip_.skeleton, carrier_, pose[static_cast<std::size_t>(carrier_)]).heading;
  }

  const Clip& clip() const { return clip_; }

 private:
  std::vector<Transform> pose_at(double time) const {
    if (clip_.frame_count() == 0) return clip_.skeleton.reference;
    const double last = clip_.frame_count() - 1;
    std::vector<Transform> pose(static_cast<std::size_t>(clip_.joint_count()));
    clip_.get_pose(static_cast<int>(std::clamp(std::round(time * clip_.rate), 0.0, last)), pose);
    return pose;
  }

  Clip clip_;
  std::optional<DrawnBody> body_;
  BoneStyle style_;
  int carrier_ = 0;
};

MovingActor actor_of(const std::string& path, Clip clip, const Body& body, SkinMethod method,
                     const DecodedImages& images) {
  MovingActor actor;
  actor.path = path;
  actor.name = name_of_input(path);
  actor.has_body = body.model != nullptr;
  actor.frame_count = clip.frame_count();
  actor.rate = clip.rate;
  actor.duration = clip.duration();
  actor.facts = counted(clip.joint_count(), "joint");
  if (actor.frame_count > 0) {
    actor.facts +=
        fmt::format(", {}, {} fps", counted(actor.frame_count, "frame"), readable(clip.rate, 4));
  }
  const auto source = std::make_shared<const ClipActor>(std::move(clip), body, method, images);
  actor.at = [source](double time) { return source->at(time); };
  actor.carrier = [source](double time) { return source->carrier(time); };
  actor.heading = [source](double time) { return source->heading(time); };
  return actor;
}

// A node scene, drawn as its meshes or as its joints.
class SceneActor {
 public:
  // With the base colours, textures and vertex colours of its meshes; if all are one grey, in the
  // default body colour.
  static Result<std::shared_ptr<const SceneActor>> create(nodes::Scene scene, int animation,
                                                          bool bones, const DecodedImages& images) {
    auto actor = std::make_shared<SceneActor>(std::move(scene));
    actor->animation_ = animation;
    auto evaluator = nodes::Evaluator::create(actor->scene_);
    if (!evaluator) return evaluator.error();
    actor->evaluator_ = std::make_unique<nodes::Evaluator>(std::move(*evaluator));
    const nodes::Evaluator& from = *actor->evaluator_;
    for (const nodes::Instance& instance : from.instances()) {
      actor->triangles_.push_back(
          std::make_shared<render::Triangles>(from.primitive(instance).triangles));
    }
    const bool has_surface = std::any_of(actor->triangles_.begin(), actor->triangles_.end(),
                                         [](const auto& triangles) { return !triangles->empty(); });
    actor->bones_ = !from.joints().empty() && (bones || !has_surface);
    if (!actor->bones_ && !has_surface) {
      return Error("figure-input", "the file has neither meshes nor joints");
    }
    actor->set_style();
    actor->set_looks(images);
    if (animation >= 0) {
      const auto times = from.key_times(animation);
      if (!times.empty()) actor->duration_ = std::max(0.0, times.back());
    }
    return std::shared_ptr<const SceneActor>(actor);
  }
  explicit SceneActor(nodes::Scene scene) : scene_(std::move(scene)) {}

  double duration() const { return duration_; }
  bool has_body() const { return !bones_; }
  std::string facts() const {
    return fmt::format("{}, {}", counted(static_cast<int>(triangles_.size()), "mesh", "meshes"),
                       counted(static_cast<int>(evaluator_->joints().size()), "joint"));
  }

  render::Actor at(double time) const {
    nodes::Evaluation moment;
    evaluator_->evaluate(animation_, time, moment);
    const auto joints = positions(moment);
    render::Actor actor;
    if (bones_) {
      actor = bone_actor(style_, joints);
    } else {
      for (std::size_t i = 0; i < triangles_.size(); ++i) {
        if (looks_[i]) actor.surfaces.push_back(surface(moment, i));
      }
    }
    actor.centre = joints.empty() ? middle(actor) : Vec3(joints[0].cast<double>());
    actor.centre.y() = 0;
    return actor;
  }

  Vec3 carrier(double time) const {
    if (evaluator_->joints().empty()) return middle(at(time));
    nodes::Evaluation moment;
    evaluator_->place_nodes(animation_, time, moment);
    return positions(moment)[0].cast<double>();
  }

 private:
  static Vec3 middle(const render::Actor& actor) {
    const render::Bounds box = render::bounds(actor);
    return 0.5 * (box.low + box.high);
  }

  std::vector<Vec3f> positions(const nodes::Evaluation& moment) const {
    std::vector<Vec3f> result;
    for (const int joint : evaluator_->joints()) {
      const Mat4& matrix = moment.node_to_world[static_cast<std::size_t>(joint)];
      result.push_back(matrix.topRightCorner<3, 1>().cast<float>());
    }
    return result;
  }

  render::Surface surface(const nodes::Evaluation& moment, std::size_t instance) const {
    render::Surface result;
    for (const Vec3& point : moment.positions[instance]) {
      result.positions.push_back(point.cast<float>());
    }
    for (const Vec3& normal : moment.normals[instance]) {
      result.normals.push_back(normal.cast<float>());
    }
    result.triangles = triangles_[instance];
    result.colours = vertex_colours_[instance];
    if (result.colours.empty()) result.colours = {looks_[instance]->colour};
    result.paint = looks_[instance]->paint;
    return result;
  }

  void set_looks(const DecodedImages& images) {
    bool chosen = false, drawn = false;
    std::optional<render::Colour> before;
    vertex_colours_.resize(triangles_.size());
    for (const nodes::Instance& instance : evaluator_->instances()) {
      const nodes::Primitive& primitive = evaluator_->primitive(instance);
      static const Material kUsual;
      const auto place = static_cast<std::size_t>(std::max(primitive.material_index, 0));
      const Material& material = primitive.material_index >= 0 ? scene_.materials[place] : kUsual;
      const auto set = static_cast<std::size_t>(material.base_color_texture.set);
      const auto& more = primitive.more_texture_coordinates;
      looks_.push_back(look_of(material,
                               set == 0             ? primitive.texture_coordinates
                               : set <= more.size() ? more[set - 1]
                                                    : nullptr,
                               images));
      drawn = drawn || (looks_.back() && !primitive.triangles.empty());
      if (!looks_.back()) continue;
      if (primitive.colours != nullptr) {
        chosen = true;
        // A texture has the base colour as its factor.
        const Vec3f factor = looks_.back()->paint != nullptr ? Vec3f(Vec3f::Ones())
                                                             : Vec3f(material.base_color.head<3>());
        for (const Vec4f& colour : *primitive.colours) {
          vertex_colours_[looks_.size() - 1].push_back(
              render::to_colour(factor.cwiseProduct(colour.head<3>())));
        }
      }
      const render::Colour& colour = looks_.back()->colour;
      const bool grey = colour.red == colour.green && colour.green == colour.blue;
      chosen =
          chosen || looks_.back()->paint != nullptr || !grey || (before && !(*before == colour));
      before = colour;
    }
    // One grey for all is what exporters write where nobody chose a colour.
    if (!chosen || !drawn) looks_.assign(triangles_.size(), SurfaceLook{kBodyColour, nullptr});
  }

  // Joint colours by name; names need not be unique here.
  void set_style() {
    Skeleton skeleton;
    nodes::Evaluation still;
    evaluator_->place_nodes(-1, 0, still);
    const auto& joints = evaluator_->joints();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const auto node = static_cast<std::size_t>(joints[i]);
      skeleton.add(scene_.nodes[node].name, evaluator_->joint_parents()[i],
                   nodes::rigid_part(still.node_to_world[node]));
    }
    if (check(skeleton)) {
      style_ = bone_style(skeleton);
      return;
    }
    style_.parents = skeleton.parents;
    style_.colours.assign(joints.size(), side_colour(BodySide::middle));
    style_.radius = bone_radius(reference_extent(skeleton));
  }

  nodes::Scene scene_;
  std::unique_ptr<nodes::Evaluator> evaluator_;
  std::vector<std::shared_ptr<const render::Triangles>> triangles_;  // [instances]
  std::vector<std::optional<SurfaceLook>> looks_;            // [instances]; empty: not drawn
  std::vector<std::vector<render::Colour>> vertex_colours_;  // [instances][vertices] or none
  BoneStyle style_;
  bool bones_ = false;
  int animation_ = -1;  // that is shown
  double duration_ = 0;
};

// The files that were read, before bodies and motions are matched.
struct Read {
  struct Motion {
    std::size_t place;  // input index
    std::string path;
    Clip clip;
    Body body;
    bool made = false;  // the body, for this motion
  };
  struct Character {
    std::size_t place;
    std::string path;
    Body body;
    bool used = false;
  };
  std::vector<Motion> motions;
  std::vector<Character> models;
  std::map<std::size_t, MovingActor> actors;  // keyed by input index
  DecodedImages images;                       // of all of them
};

// Warnings about materials matter only if they are drawn: with images or vertex colours.
void report_scene(const nodes::Scene& scene, ToolContext& context) {
  const auto coloured = [](const nodes::Mesh& mesh) {
    return std::ranges::any_of(mesh.primitives, [](const nodes::Primitive& primitive) {
      return primitive.colours != nullptr;
    });
  };
  const bool pictured = std::ranges::any_of(scene.materials,
                                            [](const Material& material) {
                                              return static_cast<bool>(material.base_color_texture);
                                            }) ||
                        std::ranges::any_of(scene.meshes, coloured);
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    if (pictured || diagnostic.code != "gltf-material") context.diagnose(diagnostic);
  }
}

Status add_file(const std::string& path, std::size_t place, const ActorOptions& options,
                ToolContext& context, Read& read) {
  const bool bones = options.body == BodyChoice::none;
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  if (io::is_shown_model(kind)) {
    auto shown = io::open_shown_model(*input, context);
    if (!shown) return shown.error();
    if (!bones && !shown->model.texture_coordinates.empty()) {
      decode_base_colours(shown->materials, path, context, read.images);
    }
    Body body{std::make_shared<Model>(std::move(shown->model)), std::move(shown->materials)};
    read.models.push_back({place, path, std::move(body), false});
    return {};
  }
  switch (kind) {
    case Kind::glb:
    case Kind::gltf: {
      auto scene = io::open_scene(*input, context, !bones);
      if (!scene) return scene.error();
      decode_base_colours(scene->materials, path, context, read.images);
      report_scene(*scene, context);
      const auto animation = choose_animation(*scene, options.clip, path, context);
      if (!animation) return animation.error();
      const auto source = SceneActor::create(std::move(*scene), *animation, bones, read.images);
      if (!source) return Error(source.error()).in_file(path);
      MovingActor actor;
      actor.path = path;
      actor.name = name_of_input(path);
      actor.facts = (*source)->facts();
      actor.duration = (*source)->duration();
      actor.has_body = (*source)->has_body();
      actor.at = [kept = *source](double time) { return kept->at(time); };
      actor.carrier = [kept = *source](double time) { return kept->carrier(time); };
      actor.heading = [](double) { return 0.0; };
      read.actors.emplace(place, std::move(actor));
      return {};
    }
    case Kind::cam:
      return Error("figure-input", "a camera has no actor",
                   "give a motion, model, character or glTF file")
          .in_file(path);
    default: {
      auto clip = io::open_motion(*input, context);
      if (!clip) return std::move(clip).error().in_file(path);
      read.motions.push_back({place, path, std::move(*clip), {}});
      return {};
    }
  }
}

// Assigns each model to the motions of its skeleton; models without a motion are static.
void share_models(bool bones, SkinMethod method, Read& read) {
  for (Read::Character& character : read.models) {
    for (Read::Motion& motion : read.motions) {
      const Model& model = *character.body.model;
      if (motion.body.model != nullptr ||
          !difference_in_structure(motion.clip.skeleton, model.skeleton).empty()) {
        continue;
      }
      character.used = true;
      if (!bones && !model.triangles.empty()) motion.body = character.body;
    }
  }
  for (const Read::Character& character : read.models) {
    if (character.used) continue;
    Clip still;
    still.skeleton = character.body.model->skeleton;
    const bool drawn = !bones && !character.body.model->triangles.empty();
    read.actors.emplace(character.place,
                        actor_of(character.path, std::move(still), drawn ? character.body : Body(),
                                 method, read.images));
  }
}

bool same_reference(const Clip& a, const Clip& b) {
  const auto same = [](const Transform& one, const Transform& other) {
    return one.position == other.position && one.orientation.coeffs() == other.orientation.coeffs();
  };
  return difference_in_structure(a.skeleton, b.skeleton).empty() &&
         std::ranges::equal(a.skeleton.reference, b.skeleton.reference, same);
}

Status make_bodies(BodyChoice choice, ToolContext& context, Read& read) {
  if (choice == BodyChoice::none) return {};
  const auto bare = std::count_if(read.motions.begin(), read.motions.end(),
                                  [](const Read::Motion& motion) { return !motion.body.model; });
  if (choice == BodyChoice::automatic) choice = bare > 2 ? BodyChoice::low : BodyChoice::medium;
  const BodyOptions how = body_options(choice, context);
  for (Read::Motion& motion : read.motions) {
    if (motion.body.model != nullptr) continue;
    const auto same = std::ranges::find_if(read.motions, [&](const Read::Motion& other) {
      return &other < &motion && other.made && same_reference(other.clip, motion.clip);
    });
    if (same != read.motions.end()) {
      motion.body.model = same->body.model;
      continue;
    }
    motion.made = true;
    auto body = make_body(motion.clip, how);
    if (!body) return std::move(body).error().in_file(motion.path);
    motion.body.model = std::make_shared<Model>(std::move(body->model));
  }
  return {};
}

}  // namespace

void add_clip_option(CommandOptions& command, std::string& clip) {
  command.add_option("--clip NAME", clip,
                     "Animation of a glTF file that has several: name or number from 0 [the one "
                     "that moves most joints]");
}

namespace {

Result<double> time_of(const std::string& text, const char* option, const MovingActor& actor,
                       double otherwise) {
  if (text.empty()) return otherwise;
  const auto time = parse_clip_time(text);
  if (!time) return Error("usage", fmt::format("{} {}: {}", option, text, time.error().message));
  if (time->in_frames && actor.frame_count == 0) {
    return Error("usage", fmt::format("{} {}: the file has no frames, only seconds", option, text))
        .in_file(actor.path);
  }
  const double seconds = time->seconds(actor.rate);
  if (!(seconds >= 0 && seconds <= actor.duration + 1e-6)) {
    return Error("usage", fmt::format("{} {}: the motion lasts {} s", option, text,
                                      readable(actor.duration)))
        .in_file(actor.path);
  }
  return seconds;
}

}  // namespace

Result<ImageSpan> span_of(const MovingActor& actor, const std::string& from_text,
                          const std::string& to_text) {
  const auto from = time_of(from_text, "--from", actor, 0.0);
  if (!from) return from.error();
  const auto to = time_of(to_text, "--to", actor, actor.duration);
  if (!to) return to.error();
  if (*from > *to) return Error("usage", "--from is after --to");
  ImageSpan span;
  span.start = *from;
  span.end = *to;
  if (actor.frame_count > 0) {
    span.rate = actor.rate;
    span.first = static_cast<int>(std::lround(*from * actor.rate));
    span.last = std::min(static_cast<int>(std::lround(*to * actor.rate)), actor.frame_count - 1);
  }
  return span;
}

Result<std::vector<MovingActor>> read_actors(const std::vector<std::string>& paths,
                                             const ActorOptions& options, ToolContext& context) {
  Read read;
  const bool bones = options.body == BodyChoice::none;
  const SkinMethod method = options.method;
  for (std::size_t place = 0; place < paths.size(); ++place) {
    if (Status status = add_file(paths[place], place, options, context, read); !status) {
      return status.error();
    }
  }
  share_models(bones, method, read);
  if (Status status = make_bodies(options.body, context, read); !status) return status.error();
  for (Read::Motion& motion : read.motions) {
    read.actors.emplace(motion.place, actor_of(motion.path, std::move(motion.clip), motion.body,
                                               method, read.images));
  }
  std::vector<MovingActor> actors;
  for (auto& [place, actor] : read.actors) actors.push_back(std::move(actor));
  return actors;
}

}  // namespace krok::cli
