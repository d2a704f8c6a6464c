#include "tools/krok-view/files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>

#include "body/body.h"
#include "character/sampling.h"
#include "core/index.h"
#include "core/text.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "formats/registry/registry.h"
#include "ik/anatomical_limits.h"
#include "ik/solver.h"
#include "nodes/animation_choice.h"
#include "ragdoll/bodies.h"
#include "roles/body_frame.h"
#include "roles/roles.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/goal_input.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::view {

namespace {

namespace fs = std::filesystem;

using krok::ik::Goal;

const char* name_of_kind(Goal::Kind kind) {
  switch (kind) {
    case Goal::Kind::position:
      return "position";
    case Goal::Kind::orientation:
      return "orientation";
    case Goal::Kind::pose:
      return "pose";
    case Goal::Kind::look_at:
      return "look-at";
    case Goal::Kind::pole:
      return "pole";
    case Goal::Kind::balance:
      break;
  }
  return "balance";
}

// From the end effector upwards.
std::vector<int> chain_of(const Goal& goal, const Skeleton& skeleton) {
  std::vector<int> chain;
  if (goal.kind == Goal::Kind::balance) return chain;
  for (int joint = goal.joint; joint >= 0; joint = skeleton.parents[at(joint)]) {
    if (goal.depth > 0 && static_cast<int>(chain.size()) == goal.depth) break;
    chain.push_back(joint);
  }
  return chain;
}

class GoalViewer {
 public:
  GoalViewer(const Clip& clip, const RoleMap& roles)
      : clip_(clip),
        body_(krok::ik::body_masses(clip.skeleton, roles)),
        pose_(clip.skeleton.names.size()) {
    options_.masses = body_.masses;
    options_.mass_centres = body_.centres;
    options_.iterations = 0;
  }

  // The solver says what is wrong with a goal.
  Status check(const krok::ik::KeyedGoal& keyed) {
    auto solver = krok::ik::Solver::create(clip_.skeleton.parents, {}, options_);
    if (!solver) return solver.error();
    clip_.get_pose(0, pose_);
    const Goal goal = goal_in_frame(keyed, clip_, 0);
    const auto outcome = solver->solve({&goal, 1}, pose_);
    return outcome ? Status() : Status(outcome.error());
  }

  draw::ViewedGoal view(const krok::ik::KeyedGoal& keyed) {
    draw::ViewedGoal viewed;
    viewed.name = keyed.name;
    viewed.kind = name_of_kind(keyed.goal.kind);
    viewed.chain = chain_of(keyed.goal, clip_.skeleton);
    for (int f = 0; f < clip_.frame_count(); ++f) viewed.frames.push_back(frame(keyed, f));
    return viewed;
  }

 private:
  draw::ViewedGoal::Frame frame(const krok::ik::KeyedGoal& keyed, int f) {
    draw::ViewedGoal::Frame shown;
    shown.strength = strength_at(keyed, f / clip_.rate, clip_.duration(), clip_.rate);
    if (!(shown.strength > 0)) return shown;
    const Goal goal = goal_in_frame(keyed, clip_, f);
    clip_.get_pose(f, pose_);
    const auto missed = residuals({&goal, 1}, clip_.skeleton.parents, pose_, options_);
    shown.distance = missed.front().distance;
    shown.angle = missed.front().angle;
    set_ends(keyed, goal, shown);
    return shown;
  }

  // The line that is drawn: from what is moved to where it is to be, or to point to.
  void set_ends(const krok::ik::KeyedGoal& keyed, const Goal& goal,
                draw::ViewedGoal::Frame& shown) const {
    switch (goal.kind) {
      case Goal::Kind::balance:
        shown.from = shown.to = centre_of_mass();
        shown.to.y() = lowest(keyed.support_joints);
        return;
      case Goal::Kind::orientation:
        shown.from = shown.to = pose_[at(goal.joint)].position;
        return;
      case Goal::Kind::pole:
        shown.from = pose_[at(goal.joint)].position;
        break;
      default:
        shown.from = pose_[at(goal.joint)] * goal.point;
        break;
    }
    shown.to = goal.target;
  }

  Vec3 centre_of_mass() const {
    Vec3 sum = Vec3::Zero();
    double mass = 0;
    for (std::size_t j = 0; j < pose_.size(); ++j) {
      sum += body_.masses[j] * (pose_[j] * body_.centres[j]);
      mass += body_.masses[j];
    }
    return mass > 0 ? Vec3(sum / mass) : pose_[0].position;
  }

  double lowest(const std::vector<int>& joints) const {
    double low = std::numeric_limits<double>::infinity();
    for (const int joint : joints) low = std::min(low, pose_[at(joint)].position.y());
    return joints.empty() ? 0 : low;
  }

  const Clip& clip_;
  krok::ik::BodyMasses body_;
  krok::ik::Options options_;
  std::vector<Transform> pose_;
};

// The goals of a file (formats/goals) as a motion meets them in each frame: full targets, whatever
// the goal's strength. Codes: those of open_goals(); ik-goal for a goal that cannot be, such as a
// pole without joints above and below.
Result<std::vector<draw::ViewedGoal>> viewed_goals(const std::string& path, const Clip& clip,
                                                   ToolContext& context) {
  const RoleMap roles = find_roles(clip.skeleton);
  const auto opened = open_goals(path, facing_skeleton(clip, roles), roles, context);
  if (!opened) return opened.error();
  std::vector<draw::ViewedGoal> all;
  if (clip.frame_count() == 0) return all;
  GoalViewer viewer(clip, roles);
  for (const krok::ik::KeyedGoal& goal : opened->goals) {
    if (Status status = viewer.check(goal); !status) {
      return std::move(status).error().in_file(path);
    }
    all.push_back(viewer.view(goal));
  }
  return all;
}

const Material& translucent() {
  static const Material kMaterial = [] {
    Material material;
    material.name = "bodies";
    material.base_color = Vec4f(0.35f, 0.6f, 0.85f, 0.45f);
    material.alpha = Material::Alpha::blend;
    return material;
  }();
  return kMaterial;
}

// Shows the rigid bodies of a file (formats/ragdoll) on all motions, translucent, in place of other
// bodies. Codes: those of ragdoll_file::read(); usage without a motion.
Status show_ragdoll_bodies(const std::string& path, ToolContext& context, Files& files) {
  if (path.empty()) return {};
  if (files.motions.empty()) {
    return Error("usage", "--bodies needs a motion", "give the .anim that krok-ragdoll wrote");
  }
  const auto file = context.open_input(path);
  if (!file) return file.error();
  for (Files::Motion& motion : files.motions) {
    const auto read = ragdoll_file::read(file->text(), &motion.clip.skeleton);
    if (!read) return Error(read.error()).in_file(path);
    files.bodies.push_back(krok::ragdoll::body_meshes(motion.clip.skeleton, read->bodies));
    motion.body = &files.bodies.back();
    motion.materials = {&translucent(), 1};
  }
  return {};
}

using registry::Kind;

// Empty for standard input.
std::string folder_of(const std::string& path) {
  if (path == "-") return {};
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Contacts and keytimes: from the sidecar of the motion, or detected.
Result<MotionKeys> keys_of(const std::string& path, const Clip& clip, KeysChoice choice,
                           ToolContext& context) {
  if (choice == KeysChoice::none) return MotionKeys();
  if (choice == KeysChoice::automatic) {
    auto sidecar = read_keys_beside(path, clip, context);
    if (!sidecar) return std::move(sidecar).error();
    return *sidecar ? std::move((*sidecar)->keys) : MotionKeys();
  }
  return find_keys(path, clip, find_roles(clip.skeleton), context);
}

// The page contains the file itself; it is parsed for its errors and for what its keys tell of its
// animations.
Status add_glb(const std::string& path, std::vector<std::byte> bytes, const std::string& wanted,
               Files& files) {
  gltf::ReadOptions as_is;
  as_is.draco = false;
  const auto scene = gltf::read(bytes, as_is);
  if (!scene) return Error(scene.error()).in_file(path);
  auto shown = gltf::plain_channels(bytes);
  if (!shown) return std::move(shown).error().in_file(path);
  Files::Glb glb{path, name_of_input(path), *std::move(shown), {}, {}, 0};
  for (const nodes::Animation& animation : scene->animations) {
    Diagnostics notes;
    const auto chosen = character::choose_sampling(animation, {}, notes);
    if (!chosen) return Error(chosen.error()).in_file(path);
    glb.animations.push_back(animation.name);
    glb.rates.push_back(chosen->sampling.rate);
  }
  Diagnostics ignored;
  const auto shown_first = choose_animation(*scene, wanted, path, ignored);
  if (!shown_first) return shown_first.error();
  glb.animation = std::max(0, *shown_first);
  files.glbs.push_back(std::move(glb));
  return {};
}

// Code of a file that the page cannot decode by itself, Draco's: it is read as an FBX is.
constexpr std::string_view kCompressed = "gltf-compression";

// Refuses a take of which no browser shows a page well, before it is read.
Status check_length(const InputFile& input) {
  constexpr double kMaxTransforms = 12e6, kBytesEach = 8.2;  // in the page
  const auto count = [&](const FrameSource& frames) -> Status {
    const double transforms = 1.0 * frames.frame_count * frames.joint_count();
    if (transforms <= kMaxTransforms) return {};
    return Error(
        "view-long",
        fmt::format("{} of {} make a page of {} MB; {} MB are the limit",
                    counted(frames.frame_count, "frame"), counted(frames.joint_count(), "joint"),
                    std::llround(1e-6 * kBytesEach * transforms),
                    std::llround(1e-6 * kBytesEach * kMaxTransforms)),
        "krok-edit cuts a part out with --from and --to, or thins it out with --rate 30");
  };
  io::PlainInputs quiet;  // it is read afterwards
  const auto seen = io::stream_motion(input, quiet, count);
  return seen ? Status() : Status(Error(seen.error()).in_file(input.path()));
}

Status add_file(const std::string& path, KeysChoice choice, ToolContext& context, Files& files) {
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  switch (kind) {
    case Kind::glb: {
      const auto bytes = input->bytes();
      const Status added = add_glb(path, {bytes.begin(), bytes.end()}, input->part(), files);
      if (added || added.error().code != kCompressed) return added;
      break;
    }
    case Kind::gltf: {
      // A page cannot open external files, so buffers and images are packed.
      gltf::ReadOptions packing;
      packing.folder = folder_of(path);
      packing.draco = false;
      auto packed = gltf::pack_glb(input->bytes(), packing);
      if (!packed && packed.error().code == kCompressed) break;
      if (!packed) return std::move(packed).error().in_file(path);
      for (Diagnostic& diagnostic : packed->diagnostics) context.diagnose(std::move(diagnostic));
      for (const std::string& beside : packed->files) {
        if (auto opened = context.open_input(beside); !opened) return opened.error();
      }
      const Status added = add_glb(path, std::move(packed->bytes), input->part(), files);
      if (added || added.error().code != kCompressed) return added;
      break;
    }
    case Kind::anim:
    case Kind::bvh:
      if (input->bytes().size() < kLongTake) break;
      if (Status status = check_length(*input); !status) return status;
      break;
    default:
      break;
  }
  auto actor = io::open_actor(*input, context, {.every_clip = true, .with_camera = true});
  if (!actor) return std::move(actor).error().in_file(path);
  for (Actor::Camera& camera : actor->cameras) {
    files.cameras.push_back({name_of_input(path), std::move(camera.track)});
  }
  if (actor->skeleton().empty()) return {};
  std::vector<Actor::Motion> motions = std::move(actor->motions);
  actor->motions.clear();
  const bool several = motions.size() > 1;
  const bool has_mesh = actor->has_mesh();
  if (has_mesh || motions.empty()) {
    files.models.push_back({path, name_of_input(path), *std::move(actor), !motions.empty()});
  }
  for (Actor::Motion& one : motions) {
    // Keytimes beside a file are those of its only motion.
    auto keys = several && choice == KeysChoice::automatic
                    ? Result<MotionKeys>(MotionKeys())
                    : keys_of(path, one.clip, choice, context);
    if (!keys) return std::move(keys).error().in_file(path);
    Files::Motion& motion = files.motions.emplace_back();
    motion.path = path;
    motion.name = name_of_input(path) + (several ? "#" + one.name : "");
    motion.clip = std::move(one.clip);
    motion.keys = *std::move(keys);
    if (!has_mesh) continue;
    motion.body = &files.models.back().actor.model;
    motion.materials = files.models.back().actor.materials;
  }
  return {};
}

void share_models(Files& files, ToolContext& context) {
  const bool moves = !files.motions.empty();
  for (Files::Character& character : files.models) {
    for (Files::Motion& motion : files.motions) {
      if (motion.body != nullptr || !character.actor.has_mesh()) continue;
      if (!difference_in_structure(motion.clip.skeleton, character.actor.model.skeleton).empty())
        continue;
      motion.body = &character.actor.model;
      motion.materials = character.actor.materials;
      character.used = true;
    }
  }
  for (const Files::Glb& glb : files.glbs) {
    if (!moves || !glb.animations.empty()) continue;
    context.warn("view-still",
                 fmt::format("{} is shown without motion: it has no animation", glb.name),
                 fmt::format("krok-skin {} IN.anim --retarget -o OUT.glb makes one of a motion",
                             shown(glb.path)));
  }
  for (Files::Character& character : files.models) {
    if (character.used) continue;
    if (moves) {
      context.warn(
          "view-still",
          fmt::format("{} is shown without motion: no motion here is of its "
                      "skeleton",
                      character.name),
          fmt::format("krok-retarget IN --onto {} makes one of it", shown(character.path)));
    }
    Files::Motion still{character.path, character.name, {}, nullptr, {}, {}, {}};
    still.clip.skeleton = character.actor.model.skeleton;
    if (character.actor.has_mesh()) {
      still.body = &character.actor.model;
      still.materials = character.actor.materials;
    }
    files.motions.push_back(std::move(still));
  }
}

bool same_reference(const Skeleton& a, const Skeleton& b) {
  static constexpr double kSame = 1e-6;  // metres, and of quaternions
  if (a.end_sites != b.end_sites || !difference_in_structure(a, b).empty()) return false;
  return std::ranges::equal(
      a.reference, b.reference, [](const Transform& one, const Transform& other) {
        return (one.position - other.position).norm() < kSame &&
               (one.orientation.coeffs() - other.orientation.coeffs()).norm() < kSame;
      });
}

// Motions of one skeleton, such as takes of one actor, share a body.
Status build_bodies(const Options& options, ToolContext& context, Files& files) {
  if (options.body == BodyChoice::none) return {};
  std::vector<std::vector<Files::Motion*>> actors;
  for (Files::Motion& motion : files.motions) {
    if (motion.body != nullptr) continue;
    const auto known = std::ranges::find_if(actors, [&](const auto& actor) {
      return same_reference(actor.front()->clip.skeleton, motion.clip.skeleton);
    });
    if (known != actors.end()) {
      known->push_back(&motion);
    } else {
      actors.push_back({&motion});
    }
  }
  BodyChoice choice = options.body;
  if (choice == BodyChoice::automatic) {
    choice = actors.size() <= 2 ? BodyChoice::medium : BodyChoice::low;
  }
  BodyOptions how = body_options(choice, context);
  const bool many = actors.size() > 2;
  // Of many the number is shown, not the steps of each.
  if (many) {
    how.progress = nullptr;
    context.progress->begin("making bodies", actors.size());
  }
  for (const auto& actor : actors) {
    auto body = make_body(actor.front()->clip, how);
    if (!body) return std::move(body).error().in_file(actor.front()->path);
    if (many) context.progress->advance(1);
    files.bodies.push_back(std::move(body->model));
    for (Files::Motion* motion : actor) motion->body = &files.bodies.back();
  }
  if (many) context.progress->end();
  return {};
}

// --clip, in all glTF files that have it.
Status choose_animation(const Options& options, Files& files) {
  if (options.clip.empty()) return {};
  bool found = false;
  std::vector<std::string> names;
  for (Files::Glb& glb : files.glbs) {
    const auto place = std::ranges::find(glb.animations, options.clip);
    names.insert(names.end(), glb.animations.begin(), glb.animations.end());
    if (place == glb.animations.end()) continue;
    glb.animation = static_cast<int>(place - glb.animations.begin());
    found = true;
  }
  if (found) return {};
  return Error("view-clip", fmt::format("no glTF file has an animation '{}'", options.clip),
               names.empty() ? "the files have no animation"
                             : fmt::format("animations: {}", fmt::join(names, ", ")));
}

Status add_goals(const Options& options, ToolContext& context, Files& files) {
  if (options.goals.empty()) return {};
  if (files.motions.empty()) {
    return Error("usage", "--goals needs a motion", "give the .anim that krok-ik wrote");
  }
  for (Files::Motion& motion : files.motions) {
    auto goals = viewed_goals(options.goals, motion.clip, context);
    if (!goals) return goals.error();
    motion.goals = std::move(*goals);
  }
  return {};
}

}  // namespace

Result<Files> read_files(const Options& options, ToolContext& context) {
  Files files;
  for (const std::string& path : options.inputs) {
    if (Status status = add_file(path, options.keys, context, files); !status) {
      status = context.leave_out(path, std::move(status).error(), options.inputs.size());
      if (!status) return status.error();
    }
  }
  if (context.left_out.size() == options.inputs.size()) return none_can_be_used();
  share_models(files, context);
  if (Status status = show_ragdoll_bodies(options.bodies, context, files); !status) {
    return status.error();
  }
  if (Status status = build_bodies(options, context, files); !status) return status.error();
  if (Status status = add_goals(options, context, files); !status) return status.error();
  if (Status status = choose_animation(options, files); !status) return status.error();
  return files;
}

}  // namespace krok::cli::view
