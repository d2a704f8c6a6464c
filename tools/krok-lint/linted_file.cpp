#include "tools/krok-lint/linted_file.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>

#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/io/open_character.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "lint/mesh_rules.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "nodes/evaluate.h"
#include "ragdoll/overlaps.h"
#include "tools/cli/paths.h"

namespace krok::cli::lint {

namespace {

using krok::lint::Finding;

// Files that are open at once.
constexpr std::size_t kOpenFiles = 64;

// By the animation's name in a file of several. Laboratories call trials of several steps cycles.
bool is_named_loop(const LintedFile& file) {
  constexpr double kLongestCycle = 2.5;  // seconds
  const std::string name =
      ascii_lower(file.animation.empty() ? name_of_input(file.path) : file.animation);
  return name.find("loop") != std::string::npos ||
         (name.find("cycle") != std::string::npos && file.seconds(file.frames) < kLongestCycle);
}

// The height of the ground below a point, or of what is just above it.
std::optional<double> height_below(const Terrain& ground, const Vec3& point) {
  constexpr double kAbove = 0.3;  // metres that a foot may be below the surface
  const auto found = ground.at(point.x(), point.z(), point.y() + kAbove);
  if (!found) return std::nullopt;
  return found->height;
}

// Which rule a reader's warning is about.
std::optional<krok::lint::Rule> rule_of(const std::string& code) {
  using krok::lint::Rule;
  if (code == "gltf-mesh-unweighted" || code == "assimp-weights") return Rule::unweighted_vertex;
  if (code == "gltf-mesh-weights" || code == "assimp-bone") return Rule::vertex_weight;
  return std::nullopt;
}

void lint_scene_meshes(const nodes::Scene& scene, const krok::lint::Settings& settings,
                       LintedFile& file) {
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    const auto rule = rule_of(diagnostic.code);
    if (!rule || !settings.has(*rule)) continue;
    Finding finding;
    finding.rule = *rule;
    const std::size_t colon = diagnostic.message.find(": ");
    const bool named = diagnostic.message.starts_with("mesh ") && colon != std::string::npos;
    finding.mesh = named ? diagnostic.message.substr(0, colon) : "mesh";
    finding.value = 1;
    finding.detail = named ? diagnostic.message.substr(colon + 2) : diagnostic.message;
    file.findings.push_back(std::move(finding));
  }
  const auto evaluator = nodes::Evaluator::create(scene);
  if (!evaluator) return;  // the error of reading the motion
  nodes::Evaluation rest;
  evaluator->place_nodes(-1, 0, rest);
  std::set<std::tuple<int, int, int>> seen;
  for (const nodes::Instance& instance : evaluator->instances()) {
    const int skin = scene.nodes[at(instance.node)].skin;
    if (!seen.insert({instance.mesh, instance.primitive, skin}).second) continue;
    const nodes::Mesh& mesh = scene.meshes[at(instance.mesh)];
    const nodes::Primitive& shape = mesh.primitives[at(instance.primitive)];
    krok::lint::MeshView view;
    view.name = fmt::format("mesh {}", instance.mesh);
    if (!mesh.name.empty()) view.name += fmt::format(" ({})", to_utf8(mesh.name));
    view.name += fmt::format(", primitive {}", instance.primitive);
    view.positions = *shape.positions, view.triangles = shape.triangles;
    if (shape.normals) view.normals = *shape.normals;
    std::vector<std::string> names;
    std::vector<Mat4> rests;
    if (skin >= 0) {
      for (const int joint : scene.skins[at(skin)].joints) {
        names.push_back(to_utf8(scene.nodes[at(joint)].name));
        rests.push_back(rest.node_to_world[at(joint)]);
      }
      view.joint_names = names, view.rests = rests;
      view.inverse_binds = scene.skins[at(skin)].inverse_binds;
      view.influences_per_vertex = shape.influences_per_vertex;
      view.influence_joints = shape.influence_joints;
      view.influence_weights = shape.influence_weights;
    }
    for (Finding& finding : krok::lint::lint_mesh(view, settings)) {
      file.findings.push_back(std::move(finding));
    }
  }
}

// Faults of the meshes of a scene that has any; false for other files.
bool lint_scene(const InputFile& input, const krok::lint::Settings& settings, LintedFile& file) {
  using krok::lint::Rule;
  const auto& enabled = settings.enabled;
  const auto of_meshes = static_cast<std::ptrdiff_t>(Rule::unweighted_vertex);
  if (std::none_of(enabled.begin() + of_meshes, enabled.end(), [](bool rule) { return rule; })) {
    return false;
  }
  if (!io::is_scene(registry::identify(input.path(), input.bytes()))) return false;
  io::PlainInputs inputs;
  inputs.jobs = 1;
  const auto scene = io::open_scene(input, inputs);
  if (!scene || scene->meshes.empty()) return false;
  lint_scene_meshes(*scene, settings, file);
  return true;
}

// A .model or .character, which have no motion.
void lint_model(const InputFile& input, const krok::lint::Settings& settings, LintedFile& file) {
  io::PlainInputs inputs;
  const auto actor = io::open_actor(input, inputs);
  file.diagnostics = std::move(inputs.diagnostics);
  if (!actor) {
    file.error = actor.error();
    return;
  }
  krok::lint::MeshView view;
  view.name = "mesh";
  view.positions = actor->model.positions, view.normals = actor->model.normals;
  view.triangles = actor->model.triangles;
  file.findings = krok::lint::lint_mesh(view, settings);
}

// By bodies of people's proportions on the bones: clothes, and what hands hold, are no part of
// them.
void add_self_intersections(const Clip& clip, const RoleMap& roles,
                            const krok::lint::Settings& settings, krok::lint::MotionFaults& out) {
  if (!roles.humanoid) {
    out.notes.emplace_back("self-intersection: only of humanoids");
    return;
  }
  const auto bodies = ragdoll::make_bodies(clip.skeleton, roles);
  if (!bodies) {
    out.notes.push_back("self-intersection: " + bodies.error().message);
    return;
  }
  const double limit = settings.threshold(krok::lint::Rule::self_intersection) *
                       krok::lint::legs_scale(clip.skeleton, roles);
  for (const ragdoll::Overlap& overlap : ragdoll::find_overlaps(clip, *bodies, limit)) {
    const ragdoll::Body &first = (*bodies)[at(overlap.first)],
                        &second = (*bodies)[at(overlap.second)];
    Finding finding;
    finding.rule = krok::lint::Rule::self_intersection;
    finding.joint = second.joint;
    finding.first = overlap.first_frame, finding.last = overlap.last_frame;
    finding.worst = overlap.worst;
    finding.value = overlap.depth, finding.threshold = limit, finding.unit = "m";
    finding.detail = to_utf8(second.name) + " in " + to_utf8(first.name);
    out.findings.push_back(std::move(finding));
  }
}

krok::lint::MotionOptions options_for(const LintedFile& file, const Options& options,
                                      const krok::lint::MotionOptions& how) {
  krok::lint::MotionOptions mine = how;
  mine.is_loop = options.loops || is_named_loop(file);
  return mine;
}

// `whole` is all of the motion, or null for a long take, which is judged in parts.
Status lint_frames(const FrameSource& motion, const Clip* whole,
                   const std::optional<RootMotion>& removed, const Options& options,
                   const io::FindRoles& find_roles, const krok::lint::MotionOptions& how,
                   LintedFile& file) {
  file.joints = motion.skeleton.names;
  file.rate = motion.rate, file.frames = motion.frame_count;
  const auto roles = find_roles(motion.skeleton);
  if (!roles) return roles.error();
  const auto judge = [&](const Clip& clip, const krok::lint::MotionOptions& mine) {
    auto found = removed ? krok::lint::lint_motion(
                               carried_along(clip, carrying_joint(*roles), *removed), *roles, mine)
                         : krok::lint::lint_motion(clip, *roles, mine);
    if (mine.settings.has(krok::lint::Rule::self_intersection)) {
      add_self_intersections(clip, *roles, mine.settings, found);
    }
    return found;
  };
  const auto mine = options_for(file, options, how);
  const auto look = [&](const krok::lint::MotionOptions& by) {
    return whole != nullptr ? Result(judge(*whole, by))
                            : krok::lint::lint_long_take(motion, by, 1, judge);
  };
  auto faults = look(mine);
  if (!faults) return faults.error();
  file.findings.insert(file.findings.end(), std::make_move_iterator(faults->findings.begin()),
                       std::make_move_iterator(faults->findings.end()));
  file.notes = std::move(faults->notes);
  if (!options.save_baseline.empty()) {
    krok::lint::MotionOptions lower = mine;
    lower.settings = krok::lint::near_limits(mine.settings);
    auto near = look(lower);
    if (!near) return near.error();
    file.near = std::move(near->findings);
  }
  if (how.settings.has(krok::lint::Rule::duplicate)) {
    file.signature = krok::lint::signature_of(motion, *roles);
  }
  return {};
}

void lint_clip(const Clip& clip, const Options& options, const io::FindRoles& find_roles,
               const krok::lint::MotionOptions& how, LintedFile& file) {
  const Status status = lint_frames(frames_of(clip), &clip, clip.provenance.removed_root_motion,
                                    options, find_roles, how, file);
  if (!status) file.error = status.error();
}

void lint_long(const InputFile& input, const Options& options, const io::FindRoles& find_roles,
               const krok::lint::MotionOptions& how, LintedFile& file) {
  io::PlainInputs inputs;
  inputs.jobs = 1;
  std::function<Provenance()> provenance;
  const auto use = [&](const FrameSource& frames) {
    file.findings.clear();
    return lint_frames(frames, nullptr, provenance().removed_root_motion, options, find_roles, how,
                       file);
  };
  const auto read = io::stream_motion(input, inputs, use, {.provenance = &provenance});
  file.diagnostics = std::move(inputs.diagnostics);
  if (!read) file.error = read.error();
}

// One element, and one for each animation where there are several.
std::vector<LintedFile> lint_file(const InputFile& input, const Options& options,
                                  const io::FindRoles& find_roles,
                                  const krok::lint::MotionOptions& how) {
  std::vector<LintedFile> files(1);
  files[0].path = input.path();
  const auto kind = registry::identify(input.path(), input.bytes());
  if (kind == registry::Kind::model || kind == registry::Kind::character) {
    lint_model(input, how.settings, files[0]);
    return files;
  }
  if (input.bytes().size() >= kLongTake && !io::is_scene(kind)) {
    lint_long(input, options, find_roles, how, files[0]);
    return files;
  }
  io::PlainInputs inputs;
  inputs.jobs = 1;
  const auto motions = io::open_motions(input, inputs);
  files[0].diagnostics = std::move(inputs.diagnostics);
  const bool has_mesh = lint_scene(input, how.settings, files[0]);
  if (!motions && has_mesh) return files;
  if (!motions) {
    files[0].error = motions.error();
  } else if (motions->size() == 1) {
    lint_clip(motions->front().clip, options, find_roles, how, files[0]);
  } else {
    for (const Actor::Motion& motion : *motions) {
      LintedFile& file = files.emplace_back();
      file.path = input.path(), file.animation = motion.name;
      lint_clip(motion.clip, options, find_roles, how, file);
    }
  }
  return files;
}

void add_duplicates(const krok::lint::Settings& settings, std::vector<LintedFile>& files) {
  using krok::lint::Rule;
  std::vector<krok::lint::Signature> signatures;
  for (const LintedFile& file : files) signatures.push_back(file.signature);
  const double degrees = settings.threshold(Rule::duplicate);
  for (const auto& [first, second] :
       krok::lint::find_duplicates(signatures, degrees * kRadiansPerDegree)) {
    LintedFile& file = files[at(second)];
    if (file.name() == files[at(first)].name()) continue;
    Finding finding;
    finding.rule = Rule::duplicate;
    finding.last = std::max(0, file.frames - 1);
    finding.value = 1;
    finding.detail = "the same motion as " + files[at(first)].name();
    file.findings.push_back(std::move(finding));
  }
}

}  // namespace

std::string LintedFile::joint_of(const Finding& finding) const {
  return finding.joint < 0 ? finding.mesh : joints[at(finding.joint)];
}

std::string LintedFile::name() const {
  return to_utf8(path) + (animation.empty() ? "" : ": " + animation);
}

std::string quantity_text(double value, const std::string& unit) {
  if (unit == "m" && std::abs(value) < 1) return readable(1000 * value, 3) + " mm";
  if (unit.empty()) return readable(value, 3);
  return readable(value, 3) + " " + unit;
}

std::string text_of(const Finding& finding, const LintedFile& file) {
  const std::string where = file.joint_of(finding);
  std::string text = where.empty() ? "body" : printable(where);
  if (finding.joints > 1) {
    text += fmt::format(" and {} more", finding.joints - 1);
  }
  if (!finding.kind.empty()) text += ", " + finding.kind;
  const bool measured = finding.threshold > 0;  // else the detail says all
  if (!measured) return text + ": " + printable(finding.detail);
  text += ": " + quantity_text(finding.value, finding.unit);
  text += ", limit " + quantity_text(finding.threshold, finding.unit);
  if (finding.last > finding.first + 1 && finding.last - finding.first + 1 < file.frames) {
    text += fmt::format(", {:.2f} to {:.2f} s", file.seconds(finding.first),
                        file.seconds(finding.last));
  }
  if (!finding.detail.empty()) text += " (" + printable(finding.detail) + ")";
  return text;
}

krok::lint::MotionOptions judging(const Options& options, const krok::lint::Settings& settings,
                                  const Terrain* ground) {
  krok::lint::MotionOptions how;
  how.settings = settings;
  how.treadmill = options.treadmill;
  if (ground != nullptr) {
    how.ground = [ground](const Vec3& point) { return height_below(*ground, point); };
  }
  return how;
}

krok::lint::MotionFaults faults_of(const Clip& clip, const RoleMap& roles, const LintedFile& file,
                                   const Options& options, const krok::lint::MotionOptions& how) {
  // Feet of a motion in place slide as fast as it would travel.
  const auto moving = travelling(clip, carrying_joint(roles));
  return krok::lint::lint_motion(moving ? *moving : clip, roles, options_for(file, options, how));
}

std::vector<LintedFile> lint_all(const Options& options, const krok::lint::MotionOptions& how,
                                 const io::FindRoles& find_roles, ToolContext& context) {
  // Each motion takes the memory of the one before: the system is slow to take it back and give it
  // again, page by page.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
  const std::size_t total = options.inputs.size();
  std::vector<LintedFile> files;
  context.progress->begin("looking for faults", total);
  for (std::size_t begin = 0; begin < total; begin += kOpenFiles) {
    const std::size_t count = std::min(kOpenFiles, total - begin);
    std::vector<std::optional<InputFile>> inputs(count);
    std::vector<std::vector<LintedFile>> found(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string& path = options.inputs[begin + i];
      auto input = context.open_input(path);
      if (input) {
        inputs[i] = *std::move(input);
      } else {
        LintedFile& file = found[i].emplace_back();
        file.path = path, file.error = input.error();
      }
    }
    parallel_for(count, 1, context.jobs, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (inputs[i]) found[i] = lint_file(*inputs[i], options, find_roles, how);
        inputs[i].reset();
        context.progress->advance(1);
      }
    });
    for (auto& of_file : found) std::ranges::move(of_file, std::back_inserter(files));
  }
  context.progress->end();
  if (how.settings.has(krok::lint::Rule::duplicate)) add_duplicates(how.settings, files);
  for (LintedFile& file : files) {
    std::ranges::stable_sort(file.findings, [](const Finding& a, const Finding& b) {
      const auto key = [](const Finding& f) {
        return std::tuple(-static_cast<int>(krok::lint::facts_of(f.rule).severity), -f.excess());
      };
      return key(a) < key(b);
    });
  }
  return files;
}

}  // namespace krok::cli::lint
