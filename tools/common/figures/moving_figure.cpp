#include "tools/common/figures/moving_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "body/body.h"
#include "core/numbers.h"
#include "formats/registry/registry.h"
#include "motion/ground_place.h"
#include "nodes/evaluate.h"
#include "tools/common/character/character_input.h"
#include "tools/common/figures/bone_figure.h"
#include "tools/common/figures/drawn_body.h"
#include "tools/common/file_name.h"
#include "tools/common/gltf/gltf_input.h"
#include "tools/common/motion_input.h"

namespace krok {

namespace {

using registry::Kind;

// What a motion moves: a mesh, or none, and how it looks where a character tells.
struct Body {
  std::shared_ptr<const Model> model;
  std::vector<Material> materials;
};

// A clip and, if it has one, its body, with what drawing them at any moment needs.
class ClipFigure {
 public:
  ClipFigure(Clip clip, const Body& body, SkinMethod method, const DecodedPictures& pictures)
      : clip_(std::move(clip)),
        style_(bone_style(clip_.skeleton)),
        carrier_(carrying_joint(find_roles(clip_.skeleton))) {
    if (body.model != nullptr) body_.emplace(body.model, body.materials, method, pictures);
  }

  render::Figure at(double time) const {
    const auto pose = pose_at(time);
    render::Figure figure;
    if (body_) {
      figure.surfaces = body_->at(pose);
    } else {
      std::vector<Vec3f> positions;
      positions.reserve(pose.size());
      for (const Transform& joint : pose) positions.push_back(joint.position.cast<float>());
      figure = bone_figure(style_, positions);
    }
    const Vec3& place = pose[static_cast<std::size_t>(carrier_)].position;
    figure.centre = Vec3(place.x(), 0, place.z());
    return figure;
  }

  Vec3 carrier(double time) const {
    return pose_at(time)[static_cast<std::size_t>(carrier_)].position;
  }

  double heading(double time) const {
    const auto pose = pose_at(time);
    return ground_place(clip_.skeleton, carrier_, pose[static_cast<std::size_t>(carrier_)]).heading;
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

MovingFigure figure_of(const std::string& path, Clip clip, const Body& body, SkinMethod method,
                       const DecodedPictures& pictures) {
  MovingFigure figure;
  figure.path = path;
  figure.name = name_of_input(path);
  figure.has_body = body.model != nullptr;
  figure.frame_count = clip.frame_count();
  figure.rate = clip.rate;
  figure.duration = clip.duration();
  figure.facts = counted(clip.joint_count(), "joint");
  if (figure.frame_count > 0) {
    figure.facts += fmt::format(", {}, {} a second", counted(figure.frame_count, "frame"),
                                readable(clip.rate, 4));
  }
  const auto source = std::make_shared<const ClipFigure>(std::move(clip), body, method, pictures);
  figure.at = [source](double time) { return source->at(time); };
  figure.carrier = [source](double time) { return source->carrier(time); };
  figure.heading = [source](double time) { return source->heading(time); };
  return figure;
}

// A scene of nodes, as its meshes show it or as its joints.
class SceneFigure {
 public:
  // With the pictures of its materials; where there are none, it has the colour of bodies.
  static Result<std::shared_ptr<const SceneFigure>> create(nodes::Scene scene, bool bones,
                                                           const DecodedPictures& pictures) {
    auto figure = std::make_shared<SceneFigure>(std::move(scene));
    auto evaluator = nodes::Evaluator::create(figure->scene_);
    if (!evaluator) return evaluator.error();
    figure->evaluator_ = std::make_unique<nodes::Evaluator>(std::move(*evaluator));
    const nodes::Evaluator& from = *figure->evaluator_;
    for (const nodes::Instance& instance : from.instances()) {
      figure->triangles_.push_back(
          std::make_shared<render::Triangles>(from.primitive(instance).triangles));
    }
    const bool has_surface = std::any_of(figure->triangles_.begin(), figure->triangles_.end(),
                                         [](const auto& triangles) { return !triangles->empty(); });
    figure->bones_ = !from.joints().empty() && (bones || !has_surface);
    if (!figure->bones_ && !has_surface) {
      return Error("figure-input", "the file has neither meshes nor joints to be seen");
    }
    figure->set_style();
    figure->set_looks(pictures);
    if (!figure->scene_.animations.empty()) {
      const auto times = from.key_times(0);
      if (!times.empty()) figure->duration_ = std::max(0.0, times.back());
    }
    return std::shared_ptr<const SceneFigure>(figure);
  }
  explicit SceneFigure(nodes::Scene scene) : scene_(std::move(scene)) {}

  double duration() const { return duration_; }
  bool has_body() const { return !bones_; }
  std::string facts() const {
    return fmt::format("{}, {}", counted(static_cast<int>(triangles_.size()), "mesh", "meshes"),
                       counted(static_cast<int>(evaluator_->joints().size()), "joint"));
  }

  render::Figure at(double time) const {
    nodes::Evaluation moment;
    evaluator_->evaluate(animation(), time, moment);
    const auto joints = positions(moment);
    render::Figure figure;
    if (bones_) {
      figure = bone_figure(style_, joints);
    } else {
      for (std::size_t i = 0; i < triangles_.size(); ++i) {
        if (looks_[i]) figure.surfaces.push_back(surface(moment, i));
      }
    }
    figure.centre = joints.empty() ? middle(figure) : Vec3(joints[0].cast<double>());
    figure.centre.y() = 0;
    return figure;
  }

  Vec3 carrier(double time) const {
    if (evaluator_->joints().empty()) return middle(at(time));
    nodes::Evaluation moment;
    evaluator_->place_nodes(animation(), time, moment);
    return positions(moment)[0].cast<double>();
  }

 private:
  int animation() const { return scene_.animations.empty() ? -1 : 0; }

  static Vec3 middle(const render::Figure& figure) {
    const render::Bounds box = render::bounds(figure);
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
    result.colours = {looks_[instance]->colour};
    result.paint = looks_[instance]->paint;
    return result;
  }

  void set_looks(const DecodedPictures& pictures) {
    bool painted = false, drawn = false;
    for (const nodes::Instance& instance : evaluator_->instances()) {
      const nodes::Primitive& primitive = evaluator_->primitive(instance);
      static const Material kUsual;
      const auto place = static_cast<std::size_t>(std::max(primitive.material_index, 0));
      const Material& material = primitive.material_index >= 0 ? scene_.materials[place] : kUsual;
      looks_.push_back(look_of(material, primitive.texture_coordinates, pictures));
      drawn = drawn || (looks_.back() && !primitive.triangles.empty());
      painted = painted || (looks_.back() && looks_.back()->paint != nullptr);
    }
    if (!painted || !drawn) looks_.assign(triangles_.size(), SurfaceLook{kBodyColour, nullptr});
  }

  // The joints' colours by their names, which need not be unique here.
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
  std::vector<std::optional<SurfaceLook>> looks_;  // [instances]; nothing for what is left out
  BoneStyle style_;
  bool bones_ = false;
  double duration_ = 0;
};

// The files, read and not yet put together.
struct Read {
  struct Motion {
    std::size_t place;  // among the inputs
    std::string path;
    Clip clip;
    Body body;
  };
  struct Character {
    std::size_t place;
    std::string path;
    Body body;
    bool used = false;
  };
  std::vector<Motion> motions;
  std::vector<Character> models;
  std::map<std::size_t, MovingFigure> figures;  // by their place among the inputs
  DecodedPictures pictures;                     // of all of them
};

// What is odd about materials matters where one has a picture: without any, they are not shown.
void tell_of_scene(const nodes::Scene& scene, ToolContext& context) {
  const bool pictured = std::ranges::any_of(scene.materials, [](const Material& material) {
    return static_cast<bool>(material.base_color_texture);
  });
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    if (pictured || diagnostic.code != "gltf-material") context.tell(diagnostic);
  }
}

Status add_file(const std::string& path, std::size_t place, bool bones, ToolContext& context,
                Read& read) {
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  if (is_shown_model(kind)) {
    auto shown = load_shown_model(*input, kind, context);
    if (!shown) return shown.error();
    if (!bones && !shown->model.texture_coordinates.empty()) {
      decode_base_colours(shown->materials, path, context, read.pictures);
    }
    Body body{std::make_shared<Model>(std::move(shown->model)), std::move(shown->materials)};
    read.models.push_back({place, path, std::move(body), false});
    return {};
  }
  switch (kind) {
    case Kind::glb:
    case Kind::gltf: {
      auto scene = read_gltf(*input, context, !bones);
      if (!scene) return scene.error();
      decode_base_colours(scene->materials, path, context, read.pictures);
      tell_of_scene(*scene, context);
      const auto source = SceneFigure::create(std::move(*scene), bones, read.pictures);
      if (!source) return Error(source.error()).in_file(path);
      MovingFigure figure;
      figure.path = path;
      figure.name = name_of_input(path);
      figure.facts = (*source)->facts();
      figure.duration = (*source)->duration();
      figure.has_body = (*source)->has_body();
      figure.at = [kept = *source](double time) { return kept->at(time); };
      figure.carrier = [kept = *source](double time) { return kept->carrier(time); };
      figure.heading = [](double) { return 0.0; };
      read.figures.emplace(place, std::move(figure));
      return {};
    }
    case Kind::cam:
      return Error("figure-input", "a camera shows no figure",
                   "give a motion, model, character or glTF file")
          .in_file(path);
    default: {
      auto clip = read_motion(*input, context);
      if (!clip) return std::move(clip).error().in_file(path);
      read.motions.push_back({place, path, std::move(*clip), {}});
      return {};
    }
  }
}

// Each model to the motions of its skeleton; one that no motion moves stands still.
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
    read.figures.emplace(character.place,
                         figure_of(character.path, std::move(still),
                                   drawn ? character.body : Body(), method, read.pictures));
  }
}

Status make_bodies(BodyChoice choice, ToolContext& context, Read& read) {
  if (choice == BodyChoice::none) return {};
  const auto bare = std::count_if(read.motions.begin(), read.motions.end(),
                                  [](const Read::Motion& motion) { return !motion.body.model; });
  if (choice == BodyChoice::automatic) choice = bare > 2 ? BodyChoice::low : BodyChoice::medium;
  const BodyOptions how = body_options(choice, context);
  for (Read::Motion& motion : read.motions) {
    if (motion.body.model != nullptr) continue;
    auto body = make_body(motion.clip, how);
    if (!body) return std::move(body).error().in_file(motion.path);
    motion.body.model = std::make_shared<Model>(std::move(body->model));
  }
  return {};
}

}  // namespace

Result<std::vector<MovingFigure>> read_figures(const std::vector<std::string>& paths,
                                               BodyChoice body, SkinMethod method,
                                               ToolContext& context) {
  Read read;
  const bool bones = body == BodyChoice::none;
  for (std::size_t place = 0; place < paths.size(); ++place) {
    if (Status added = add_file(paths[place], place, bones, context, read); !added) {
      return added.error();
    }
  }
  share_models(bones, method, read);
  if (Status made = make_bodies(body, context, read); !made) return made.error();
  for (Read::Motion& motion : read.motions) {
    read.figures.emplace(motion.place, figure_of(motion.path, std::move(motion.clip), motion.body,
                                                 method, read.pictures));
  }
  std::vector<MovingFigure> figures;
  for (auto& [place, figure] : read.figures) figures.push_back(std::move(figure));
  return figures;
}

}  // namespace krok
