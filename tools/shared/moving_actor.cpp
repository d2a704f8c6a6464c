#include "tools/shared/moving_actor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>

#include "body/body.h"
#include "core/in_order.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "motion/hips_root.h"
#include "nodes/animation_choice.h"
#include "nodes/scene_of.h"
#include "roles/body_frame.h"
#include "scene/frame_source.h"
#include "skin/scene_of.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/bone_actor.h"
#include "tools/shared/drawn_scene.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli {

namespace {

using registry::Kind;

// A scene as it is drawn, and the animation of it that is.
struct Drawn {
  std::shared_ptr<const DrawnScene> scene;
  Skeleton skeleton;  // for headings; empty: none
  int animation = -1;
  int carrier = 0;        // joint
  double frame_rate = 0;  // of an actor's motion: drawn at its frames, not in between
  int frame_count = 0;
  int first_frame = 0;  // of the scene's; those before are not there
  // Where its body faces in the reference pose; of a file's scene that without animation, any.
  double front = 0;
  bool in_floats = false;  // what is followed is in the floats that are drawn

  SceneState state_at(double time, bool joints_alone) const {
    if (frame_count > 0) {
      const double last = frame_count - 1;
      time = (std::clamp(std::round(time * frame_rate), 0.0, last) - first_frame) / frame_rate;
    }
    SceneState state;
    state.joints_alone = joints_alone;
    scene->scene().evaluate(animation, time, state);
    return state;
  }

  static Vec3 middle(const render::Actor& actor) {
    const render::Bounds box = render::bounds(actor);
    return 0.5 * (box.low + box.high);
  }

  Vec3 carrier_of(const SceneState& state) const {
    const Vec3& place = state.joints[krok::at(carrier)].position;
    return in_floats ? Vec3(place.cast<float>().cast<double>()) : place;
  }

  render::Actor at(double time) const {
    const SceneState state = state_at(time, scene->as_bones());
    render::Actor actor = scene->at(state);
    actor.centre = state.joints.empty() ? middle(actor) : carrier_of(state);
    actor.centre.y() = 0;
    return actor;
  }

  Vec3 carrier_at(double time) const {
    const SceneState state = state_at(time, true);
    return state.joints.empty() ? middle(at(time)) : carrier_of(state);
  }

  double heading(double time) const {
    if (skeleton.empty()) return 0;
    const SceneState state = state_at(time, true);
    return wrapped(front +
                   ground_frame(skeleton, carrier, state.joints[krok::at(carrier)]).heading);
  }
};

MovingActor moving(const std::string& path, Drawn drawn) {
  MovingActor actor;
  actor.path = path;
  actor.name = name_of_input(path);
  actor.has_body = !drawn.scene->as_bones();
  actor.frame_count = drawn.frame_count;
  actor.joint_count = drawn.skeleton.joint_count();
  actor.rate = drawn.frame_rate;
  if (drawn.animation >= 0) {
    const auto& times = drawn.scene->scene().animations[at(drawn.animation)].key_times;
    if (!times.empty()) actor.duration = std::max(0.0, times.back());
  }
  const auto source = std::make_shared<const Drawn>(std::move(drawn));
  actor.at = [source](double time) { return source->at(time); };
  actor.carrier = [source](double time) { return source->carrier_at(time); };
  actor.heading = [source](double time) { return source->heading(time); };
  return actor;
}

// What was read, before bodies and motions are matched: an actor, and where it is shown: for each
// of its motions, or once at rest.
struct Read {
  struct Place {
    std::size_t index;  // of the input
    std::string path;
    std::string clip = {};  // of several of a file
  };
  struct One {
    Actor actor;
    std::vector<Place> places;
    bool one_grey_is_none = false;         // of its materials, as of glTF files
    int first_frame = 0, frame_count = 0;  // of a take whose clip is a part of it
  };
  std::vector<One> motions, models;
  std::multimap<std::size_t, MovingActor> actors;  // keyed by input index
  DecodedImages images;                            // of all of them

  void add(Read other);
  void draw(One one, SkinMethod method, bool bones);
};

void Read::add(Read other) {
  std::ranges::move(other.motions, std::back_inserter(motions));
  std::ranges::move(other.models, std::back_inserter(models));
  actors.merge(other.actors);
  images.merge(other.images);
}

void Read::draw(One one, SkinMethod method, bool bones) {
  if (one.places.empty()) return;
  const auto actor = std::make_shared<const Actor>(std::move(one.actor));
  const bool painted = !actor->materials.empty() || !actor->model.colours.empty();
  const auto scene = std::make_shared<const DrawnScene>(
      scene_of(actor, {.method = method, .by_part = painted}), images,
      DrawnSceneOptions{.bones = bones, .one_grey_is_none = one.one_grey_is_none});
  for (std::size_t i = 0; i < one.places.size(); ++i) {
    Drawn drawn{scene, actor->skeleton()};
    std::string facts = counted(actor->skeleton().joint_count(), "joint");
    if (i < actor->motions.size()) {
      const Clip& clip = actor->motions[i].clip;
      drawn.skeleton = clip.skeleton;
      drawn.animation = clip.frame_count() > 0 ? static_cast<int>(i) : -1;
      drawn.frame_count = one.frame_count > 0 ? one.frame_count : clip.frame_count();
      drawn.first_frame = one.first_frame;
      drawn.frame_rate = clip.rate;
      if (drawn.frame_count > 0) {
        facts += fmt::format(", {}, {} fps", counted(drawn.frame_count, "frame"),
                             readable(clip.rate, 4));
      }
    }
    const RoleMap roles = find_roles(drawn.skeleton);
    drawn.carrier = carrying_joint(roles);
    drawn.front = front_of(drawn.skeleton, roles);
    MovingActor made = moving(one.places[i].path, std::move(drawn));
    if (!one.places[i].clip.empty()) made.name += ": " + shown(one.places[i].clip);
    made.facts = std::move(facts);
    if (one.frame_count > 0) made.duration = (one.frame_count - 1) / made.rate;
    actors.emplace(one.places[i].index, std::move(made));
  }
}

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

// glTF files are drawn as viewers show them; the joints of one character without a mesh get a body,
// as other motions do.
Status read_gltf(const InputFile& input, std::size_t place, const ActorOptions& options,
                 ToolContext& context, Read& all) {
  const std::string& path = input.path();
  const bool bones = options.body == BodyChoice::none;
  auto read = io::open_scene(input, context, !bones);
  if (!read) return read.error();
  if (!bones && read->meshes.empty()) {
    auto actor = io::open_actor(
        input, context,
        {.clip = options.clip, .every_clip = options.every_clip && options.clip.empty()});
    if (actor && !actor->motions.empty()) {
      Read::One one{*std::move(actor), {}};
      one.actor.materials.clear();  // of no mesh
      for (const Actor::Motion& motion : one.actor.motions) {
        one.places.push_back({place, path, one.actor.motions.size() > 1 ? motion.name : ""});
      }
      all.motions.push_back(std::move(one));
      return {};
    }
  }
  const auto file = std::make_shared<const nodes::Scene>(*std::move(read));
  decode_base_colours(file->materials, path, context, all.images);
  report_scene(*file, context);
  std::vector<int> animations(file->animations.size());
  std::iota(animations.begin(), animations.end(), 0);
  if (animations.size() < 2 || !options.every_clip || !options.clip.empty()) {
    Diagnostics choice;
    const auto animation = choose_animation(*file, options.clip, path, choice);
    if (!animation) return animation.error();
    context.diagnose(choice);
    animations = {*animation};
  }
  auto scene = scene_of(file);
  if (!scene) return Error(scene.error()).in_file(path);
  const std::string facts =
      fmt::format("{}, {}", counted(static_cast<int>(scene->meshes.size()), "mesh", "meshes"),
                  counted(static_cast<int>(scene->joint_names.size()), "joint"));
  const auto drawn_scene = std::make_shared<const DrawnScene>(
      *std::move(scene), all.images, DrawnSceneOptions{.bones = bones, .one_grey_is_none = true});
  if (!drawn_scene->as_bones() && !drawn_scene->has_triangles()) {
    return Error("figure-input", "the file has neither meshes nor joints").in_file(path);
  }
  Drawn drawn{.scene = drawn_scene, .skeleton = {}, .animation = -1, .in_floats = true};
  // Several roots, or joints without names, are no body.
  if (Skeleton joints = skeleton_of(drawn_scene->scene()); check(joints)) {
    const RoleMap roles = find_roles(joints);
    drawn.carrier = carrying_joint(roles);
    if (const auto front = heading_of(roles, joints.reference)) {
      drawn.front = *front;
      drawn.skeleton = std::move(joints);
    }
  }
  for (const int animation : animations) {
    drawn.animation = animation;
    MovingActor actor = moving(path, drawn);
    actor.facts = facts;
    if (animations.size() > 1) {
      actor.name += ": " + shown(nodes::animation_name(*file, static_cast<std::size_t>(animation)));
    }
    all.actors.emplace(place, std::move(actor));
  }
  return {};
}

// The frames of a long take from options.from to options.to, and its body.
Status add_part(const InputFile& input, const ActorOptions& options, ToolContext& context,
                Read& read) {
  Read::One one;
  one.places = {{0, input.path()}};
  const auto use = [&](const FrameSource& frames) -> Status {
    const int last = frames.frame_count - 1;
    const auto frame_of = [&](const std::optional<ClipTime>& time, int otherwise) {
      if (!time) return otherwise;
      const double frame = std::round(time->seconds(frames.rate) * frames.rate);
      return static_cast<int>(std::clamp(frame, 0.0, static_cast<double>(last)));
    };
    one.frame_count = frames.frame_count;
    one.first_frame = frame_of(options.from, 0);
    const int end = std::max(one.first_frame, frame_of(options.to, last)) + 1;
    auto clip = load(part_of(frames, one.first_frame, end - one.first_frame), context.jobs);
    if (!clip) return clip.error();
    one.actor.motions.clear();
    one.actor.motions.emplace_back().clip = *std::move(clip);
    if (options.body == BodyChoice::none) return {};
    const bool medium = options.body == BodyChoice::automatic;
    BodyOptions how = body_options(medium ? BodyChoice::medium : options.body, context);
    how.progress = nullptr;
    auto body = make_body(frames, how);
    if (!body) return std::move(body).error().in_file(input.path());
    one.actor.model = std::move(body->model);
    return {};
  };
  const auto motion = io::stream_motion(input, context, use);
  if (!motion) return motion.error();
  read.motions.push_back(std::move(one));
  return {};
}

Status add_file(const std::string& path, std::size_t place, const ActorOptions& options,
                ToolContext& context, Read& read) {
  const bool bones = options.body == BodyChoice::none;
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  const bool as_model = options.first_is_model && place == 0;
  if ((kind == Kind::glb || kind == Kind::gltf) && !as_model) {
    return read_gltf(*input, place, options, context, read);
  }
  const io::Format& format = io::format_of(*input);
  if ((options.from || options.to) && input->bytes().size() >= kLongTake &&
      (kind == Kind::anim || format.open_capture != nullptr)) {
    return add_part(*input, options, context, read);
  }
  auto actor = io::open_actor(
      *input, context,
      {.clip = options.clip, .with_mesh = !bones, .with_motions = !as_model, .with_camera = true});
  if (!actor) return std::move(actor).error().in_file(path);
  if (actor->skeleton().empty()) {
    return Error("figure-input", "a camera has no actor",
                 "give a motion, model, character or glTF file")
        .in_file(path);
  }
  if (!bones && !actor->model.texture_coordinates.empty()) {
    decode_base_colours(actor->materials, path, context, read.images);
  }
  auto& list = actor->motions.empty() ? read.models : read.motions;
  list.push_back({*std::move(actor), {{place, path}}, io::is_scene(kind)});
  return {};
}

// A file read beside others: what it adds, and what the run's context is to know of it.
struct ReadBeside {
  Read read;
  Status status;
  Report report;
  std::vector<std::string> refused_inputs;
};

// Called from several threads.
ReadBeside read_beside(const std::string& path, std::size_t place, const ActorOptions& options,
                       int threads, const ToolContext& context) {
  ReadBeside one;
  OneOfMany messages;
  ToolContext own = context.beside(messages, threads);
  one.status = add_file(path, place, options, own, one.read);
  one.report = std::move(own.report);
  one.refused_inputs = std::move(own.refused_inputs);
  return one;
}

Status add_files(const std::vector<std::string>& paths, const ActorOptions& options,
                 ToolContext& context, Read& read) {
  if (paths.size() == 1) return add_file(paths[0], 0, options, context, read);
  context.progress->begin("reading", paths.size());
  Status result;
  const int threads = thread_count(context.jobs);
  const int readers = std::clamp(static_cast<int>(paths.size()), 1, threads);
  in_order<ReadBeside>(
      paths.size(), readers, paths.size(),
      [&](std::size_t i) {
        // Only the context knows whether standard input has been read.
        return paths[i] == "-" ? ReadBeside()
                               : read_beside(paths[i], i, options, threads / readers, context);
      },
      [&](std::size_t i, ReadBeside one) {
        if (paths[i] == "-") {
          const HiddenProgress hidden(context);
          one.status = add_file(paths[i], i, options, context, one.read);
        }
        context.diagnose(one.report.issues);
        std::ranges::move(one.report.inputs, std::back_inserter(context.report.inputs));
        std::ranges::move(one.report.choices, std::back_inserter(context.report.choices));
        std::ranges::move(one.refused_inputs, std::back_inserter(context.refused_inputs));
        context.progress->advance(1);
        if (one.status) {
          read.add(std::move(one.read));
        } else {
          result = context.leave_out(paths[i], std::move(one.status).error(), paths.size());
        }
        return result.ok();
      });
  context.progress->end();
  return result;
}

// Moves motions to another actor of their skeleton, which then is not shown at rest.
void move_motions(Read::One& from, Read::One& to) {
  if (to.actor.motions.empty()) to.places.clear();
  std::ranges::move(from.actor.motions, std::back_inserter(to.actor.motions));
  std::ranges::move(from.places, std::back_inserter(to.places));
  from.places.clear();
}

// Assigns the motions of a model's skeleton to it.
void share_models(bool bones, Read& read) {
  for (Read::One& model : read.models) {
    for (Read::One& motion : read.motions) {
      if (motion.places.empty() || motion.actor.has_mesh() ||
          !difference_in_structure(motion.actor.skeleton(), model.actor.skeleton()).empty()) {
        continue;
      }
      if (!bones && model.actor.has_mesh()) {
        move_motions(motion, model);
      } else {
        model.places.clear();
      }
    }
  }
}

bool same_reference(const Skeleton& a, const Skeleton& b) {
  const auto same = [](const Transform& one, const Transform& other) {
    return one.position == other.position && one.orientation.coeffs() == other.orientation.coeffs();
  };
  return difference_in_structure(a, b).empty() &&
         std::ranges::equal(a.reference, b.reference, same);
}

Status make_bodies(BodyChoice choice, ToolContext& context, Read& read) {
  if (choice == BodyChoice::none) return {};
  const auto is_bare = [](const Read::One& motion) {
    return !motion.places.empty() && !motion.actor.has_mesh();
  };
  const auto bare = std::ranges::count_if(read.motions, is_bare);
  const bool automatic = choice == BodyChoice::automatic;
  if (automatic) choice = bare > 2 ? BodyChoice::low : BodyChoice::medium;
  BodyOptions how = body_options(choice, context);
  how.progress = nullptr;
  std::vector<Read::One*> made;  // a motion of each skeleton
  for (Read::One& motion : read.motions) {
    if (!is_bare(motion)) continue;
    const auto same = std::ranges::find_if(made, [&](const Read::One* other) {
      return same_reference(other->actor.motions[0].clip.skeleton, motion.actor.skeleton());
    });
    if (same != made.end()) {
      move_motions(motion, **same);
    } else {
      made.push_back(&motion);
    }
  }
  constexpr std::size_t kMany = 24;  // each is small in a picture of all
  if (automatic && made.size() > kMany) how.detail = BodyDetail::preview;
  context.progress->begin("shaping bodies", made.size());
  Status status = make_in_order(
      made.size(), context.jobs,
      [&](std::size_t i, std::size_t) -> Status {
        Actor& actor = made[i]->actor;
        auto body = make_body(actor.motions[0].clip, how);
        if (!body) return std::move(body).error().in_file(made[i]->places[0].path);
        actor.model = std::move(body->model);
        context.progress->advance(1);
        return {};
      },
      [](std::size_t, std::size_t) -> Status { return {}; });
  context.progress->end();
  return status;
}

// A character beside a motion of another skeleton was probably meant to make that motion.
void warn_of_still_characters(const std::vector<MovingActor>& actors, ToolContext& context) {
  const auto moves = [](const MovingActor& actor) { return actor.duration > 0; };
  if (std::ranges::none_of(actors, moves)) return;
  for (const MovingActor& actor : actors) {
    if (moves(actor) || !actor.has_body || actor.joint_count < 2 || actor.frame_count > 0) continue;
    context.warn("view-still", fmt::format("{} is shown without motion: it has none", actor.name),
                 fmt::format("krok-skin {} IN.anim --retarget -o OUT.glb makes one of a motion",
                             shown(actor.path)));
  }
}

// With the addresses of all animations for files that are not read as glTF, which shows them all.
std::vector<std::string> each_clip(const std::vector<std::string>& given,
                                   const ActorOptions& options, ToolContext& context) {
  if (!options.every_clip || !options.clip.empty()) return given;
  std::vector<std::string> paths;
  for (const std::string& path : given) {
    const Kind kind = registry::kind_of_name(path);
    const bool split = io::is_scene(kind) && kind != Kind::glb && kind != Kind::gltf;
    Diagnostics notes;
    std::ranges::move(split ? io::addresses_in(path, context.limits, notes) : std::vector{path},
                      std::back_inserter(paths));
    context.diagnose(notes);
  }
  return paths;
}

Result<double> time_of(const std::optional<ClipTime>& time, const char* option,
                       const MovingActor& actor, double otherwise) {
  if (!time) return otherwise;
  if (time->in_frames && actor.frame_count == 0) {
    return Error("usage",
                 fmt::format("{} {}: the file has no frames, only seconds", option, written(*time)))
        .in_file(actor.path);
  }
  const double seconds = time->seconds(actor.rate);
  if (!(seconds >= 0 && seconds <= actor.duration + 1e-6)) {
    return Error("usage", fmt::format("{} {}: the motion lasts {} s", option, written(*time),
                                      readable(actor.duration)))
        .in_file(actor.path);
  }
  return seconds;
}

}  // namespace

Result<ImageSpan> span_of(const MovingActor& actor, const std::optional<ClipTime>& given_from,
                          const std::optional<ClipTime>& given_to) {
  const auto from = time_of(given_from, "--from", actor, 0.0);
  if (!from) return from.error();
  const auto to = time_of(given_to, "--to", actor, actor.duration);
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

Result<std::vector<MovingActor>> read_actors(const std::vector<std::string>& given,
                                             const ActorOptions& options, ToolContext& context) {
  Read read;
  const bool bones = options.body == BodyChoice::none;
  const SkinMethod method = options.method;
  const std::vector<std::string> paths = each_clip(given, options, context);
  ActorOptions how = options;
  if (paths.size() > 1) how.from = how.to = {};  // they may share a body
  if (Status status = add_files(paths, how, context, read); !status) return status.error();
  if (!paths.empty() && context.left_out.size() == paths.size()) return none_can_be_used();
  share_models(bones, read);
  if (Status status = make_bodies(options.body, context, read); !status) return status.error();
  for (auto* list : {&read.models, &read.motions}) {
    for (Read::One& one : *list) read.draw(std::move(one), method, bones);
  }
  std::vector<MovingActor> actors;
  for (auto& [place, actor] : read.actors) actors.push_back(std::move(actor));
  warn_of_still_characters(actors, context);
  return actors;
}

}  // namespace krok::cli
