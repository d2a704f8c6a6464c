#include "body/body.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <span>

#include "body/human_parts.h"
#include "body/polygonise.h"
#include "body/shapes.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "roles/body_frame.h"

namespace krok::body {

namespace {

using Weights = std::vector<std::pair<int, double>>;  // joint and weight, by joint

// Merges the weights per joint, drops negligible ones and normalises.
void tidy(Weights& weights) {
  std::stable_sort(weights.begin(), weights.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Weights merged;
  double sum = 0;
  for (const auto& [joint, weight] : weights) {
    sum += weight;
    if (!merged.empty() && merged.back().first == joint) {
      merged.back().second += weight;
    } else {
      merged.emplace_back(joint, weight);
    }
  }
  double kept = 0;
  std::erase_if(merged, [&](const auto& entry) { return entry.second < 1e-4 * sum; });
  for (const auto& entry : merged) kept += entry.second;
  for (auto& entry : merged) entry.second /= kept;
  weights = std::move(merged);
}

Weights raw_weights(const BlockedField& field, const Vec3& point) {
  Weights weights;
  const auto places = field.places(point);
  if (places.empty()) return {{0, 1.0}};
  const TubePoint& nearest = places.front();
  field.field().bind(nearest, 1.0, weights);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double radius = 1.2 * field.field().blend_radius(nearest.tube, places[i].tube);
    if (radius <= 0) continue;
    const double closeness = 1 - (places[i].value - nearest.value) / radius;
    if (closeness > 0) field.field().bind(places[i], closeness * closeness, weights);
  }
  tidy(weights);
  return weights;
}

// Fills the influences of a model that has the vertices of `mesh`: from the joints of the tube at
// each vertex and of the tubes blended with it there, then smoothed along the surface in `passes`
// steps, so that weights do not bleed from an arm to the trunk beside it. The four largest weights
// are kept.
void bind_surface(const Mesh& mesh, const BlockedField& field, int passes, int jobs, Model& model) {
  const std::size_t count = mesh.positions.size();
  std::vector<Weights> weights(count), smoothed(count);
  parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) weights[v] = raw_weights(field, mesh.positions[v]);
  });
  const auto neighbours = vertex_neighbours(mesh);
  for (int pass = 0; pass < passes; ++pass) {
    parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        Weights sum = weights[v];
        const double share = 1.0 / static_cast<double>(neighbours[v].size());
        for (const std::uint32_t u : neighbours[v]) {
          for (const auto& [joint, weight] : weights[u]) sum.emplace_back(joint, share * weight);
        }
        tidy(sum);
        smoothed[v] = std::move(sum);
      }
    });
    std::swap(weights, smoothed);
  }
  constexpr std::size_t kInfluences = 4;
  model.influences_per_vertex = static_cast<int>(kInfluences);
  model.influence_joints.assign(count * kInfluences, 0);
  model.influence_weights.assign(count * kInfluences, 0.0f);
  for (std::size_t v = 0; v < count; ++v) {
    Weights& all = weights[v];
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (std::size_t k = 0; k < std::min(all.size(), kInfluences); ++k) {
      model.influence_joints[v * kInfluences + k] = static_cast<std::uint16_t>(all[k].first);
      model.influence_weights[v * kInfluences + k] = static_cast<float>(all[k].second);
    }
  }
  normalize_influences(model);
}

// Computes the texture coordinates, see Body::model.
void map_surface(const Mesh& mesh, const BlockedField& field, int jobs, Model& model) {
  const std::size_t count = mesh.positions.size();
  model.texture_coordinates.assign(count, Vec2f::Zero());
  std::vector<double> along(count, 0);
  parallel_for(count, 256, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TubePoint place = field.nearest_place(mesh.positions[i]);
      if (place.tube < 0) continue;
      const Station station = field.field().station_at(place);
      const Vec3 offset = mesh.positions[i] - station.center;
      const double x = std::abs(offset.dot(station.side)), y = offset.dot(station.front);
      // Angle from the front without trigonometry: 0 front, 1/2 side, 1 back.
      const double whole = x + std::abs(y);
      const double quarter = whole > 0 ? 0.5 * x / whole : 0.5;
      model.texture_coordinates[i].x() = static_cast<float>(y >= 0 ? quarter : 1 - quarter);
      along[i] = std::max(0.0, station.along);
    }
  });
  const double longest = std::max(*std::max_element(along.begin(), along.end()), 1e-12);
  for (std::size_t i = 0; i < count; ++i) {
    model.texture_coordinates[i].y() = static_cast<float>(along[i] / longest);
  }
}

}  // namespace

}  // namespace krok::body

namespace krok {

namespace {

using namespace body;

struct Level {
  std::size_t vertices;
  std::size_t lattice_vertices;  // of the surface before it is simplified
  int smoothing;                 // passes over the weights
};

Level level_of(BodyDetail detail) {
  switch (detail) {
    case BodyDetail::preview:
      return {1200, 24000, 1};
    case BodyDetail::low:
      return {2500, 120000, 2};
    case BodyDetail::high:
      return {40000, 200000, 12};
    case BodyDetail::medium:
      break;
  }
  return {10000, 160000, 5};
}

// A cell size fine enough for the thinnest limb, within the limits of the level.
double cell_size(const Field& field, const Level& level) {
  // A lattice of this kind has about four vertices per squared cell.
  const auto of_vertices = [&field](std::size_t count) {
    return std::sqrt(4 * field.area_estimate() / static_cast<double>(count));
  };
  return std::clamp(0.8 * field.smallest_radius(), of_vertices(level.lattice_vertices),
                    of_vertices(4 * level.vertices));
}

// Thickens limbs that are thinner than the lattice resolution and would break up.
void thicken(Shape& shape, double least) {
  for (Tube& tube : shape.tubes) {
    for (Station& station : tube.stations) {
      station.width = std::max(station.width, least);
      station.depth = std::max(station.depth, least);
      if (station.cap > 0) station.cap = std::max(station.cap, least);
    }
  }
}

Mesh build_mesh(const BlockedField& blocked, std::size_t target, int jobs, Progress& progress) {
  progress.begin("shaping the body", 3);
  Lattice lattice(blocked, jobs);
  Mesh mesh = polygonise(lattice, jobs);
  if (!is_sphere(mesh)) {
    lattice.make_ball();
    mesh = polygonise(lattice, jobs);
  }
  // Removes slivers of the marching step, which would block edge collapses.
  smooth(mesh, jobs);
  progress.advance(1);
  std::vector<double> detail(mesh.positions.size(), 1.0);
  parallel_for(detail.size(), 256, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const TubePoint place = blocked.nearest_place(mesh.positions[v]);
      if (place.tube >= 0) detail[v] = blocked.field().detail_at(place);
    }
  });
  mesh = simplify(mesh, detail, target);
  progress.advance(1);
  relax(mesh, blocked, 4, 0.5, jobs);
  progress.end();
  return mesh;
}

// Moves the mesh into another pose of its skeleton by linear blend skinning.
void move_to(const Skeleton& skeleton, std::span<const Transform> built,
             std::span<const Transform> wanted, const Model& bound, Mesh& mesh) {
  std::vector<Transform> palette(skeleton.names.size());
  for (std::size_t j = 0; j < palette.size(); ++j) palette[j] = wanted[j] * built[j].inverse();
  const auto per_vertex = static_cast<std::size_t>(bound.influences_per_vertex);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    Vec3 moved = Vec3::Zero();
    double sum = 0;
    for (std::size_t k = v * per_vertex; k < (v + 1) * per_vertex; ++k) {
      const double weight = bound.influence_weights[k];
      moved += weight * (palette[bound.influence_joints[k]] * mesh.positions[v]);
      sum += weight;
    }
    mesh.positions[v] = moved / sum;
  }
}

Status check_request(const FrameSource& source, const BodyOptions& options) {
  if (Status status = check(source.skeleton); !status) return status;
  if (options.pose == BodyPose::frame &&
      (options.frame < 0 || options.frame >= source.frame_count)) {
    return Error(
        "body-frame",
        fmt::format("frame {} is out of range, the clip has {}", options.frame, source.frame_count),
        "frames count from 0");
  }
  const std::size_t joints = source.skeleton.names.size();
  // The surface is evaluated bone by bone: bones that all meet in one place would take hours and
  // more memory than there is.
  constexpr std::size_t kMaxBodyJoints = 2000;
  if (joints > kMaxBodyJoints) {
    return Error("body-joints",
                 fmt::format("{} joints; bodies are made for up to {}", joints, kMaxBodyJoints),
                 "pictures and pages draw the bones instead with --body none");
  }
  return {};
}

// The shape to build, and its poses.
struct Plan {
  std::vector<Transform> built;   // joint_to_world, the pose that the surface is made in
  std::vector<Transform> wanted;  // the final pose; empty if it is the same
  Shape shape;
};

Result<Plan> make_plan(const FrameSource& source, const BodyOptions& options, Body& body) {
  const Skeleton& skeleton = source.skeleton;
  const RoleMap roles = find_roles(skeleton);
  auto actor = find_human(skeleton, roles);
  body.human = actor.has_value();
  if (actor) {
    if (Status status = drop_tips_below_ankles(source, *actor); !status) return status.error();
  }
  Plan plan;
  if (options.pose == BodyPose::reference) plan.wanted = skeleton.reference;
  if (options.pose == BodyPose::frame) {
    auto wanted = pose_of(source, options.frame);
    if (!wanted) return wanted.error();
    plan.wanted = *std::move(wanted);
  }
  auto found = actor ? human_build_pose(source, roles, *actor) : general_build_pose(source);
  if (!found) return found.error();
  BuildPose pose = *std::move(found);
  // In the reference pose itself the skin is whole as that has the joints.
  if (actor && options.pose != BodyPose::reference) {
    if (Status status = untwist(source, pose.joint_to_world); !status) return status.error();
  }
  body.pose = options.pose == BodyPose::automatic   ? pose.name
              : options.pose == BodyPose::reference ? "reference"
                                                    : fmt::format("frame {}", options.frame);
  if (actor) {
    body.stature = stature_of(skeleton, roles).value_or(Stature{}).metres;
    // Built with spread fingers, so that their surfaces do not merge.
    plan.built = spread_fingers(skeleton, *actor, pose.joint_to_world);
    if (plan.wanted.empty()) plan.wanted = std::move(pose.joint_to_world);
    plan.shape = human_shape(skeleton, *actor, plan.built);
  } else {
    plan.built = std::move(plan.wanted.empty() ? pose.joint_to_world : plan.wanted);
    plan.wanted.clear();
    plan.shape = general_shape(skeleton, plan.built);
  }
  return plan;
}

}  // namespace

Result<Body> make_body(const Clip& clip, const BodyOptions& options) {
  if (Status status = check(clip); !status) return status.error();
  return make_body(frames_of(clip), options);
}

Result<Body> make_body(const FrameSource& source, const BodyOptions& options) {
  if (Status status = check_request(source, options); !status) {
    return std::move(status).error();
  }
  Progress silent;
  Progress& progress = options.progress ? *options.progress : silent;
  const Skeleton& skeleton = source.skeleton;
  Body body;
  auto planned = make_plan(source, options, body);
  if (!planned) return planned.error();
  Plan plan = *std::move(planned);

  const Level level = level_of(options.detail);
  const double cell = cell_size(Field(plan.shape), level);
  thicken(plan.shape, 0.8 * cell);
  const Field field(plan.shape);
  const double size = field.bounds().diagonal().norm();
  if (!(size > 1e-9) || !(size < 1e9)) {
    return Error("body-size", fmt::format("the skeleton is {} m in size", size),
                 "import it with the correct unit of length");
  }
  const BlockedField blocked(field, cell, options.jobs);
  Mesh mesh = build_mesh(blocked, level.vertices, options.jobs, progress);

  Model& model = body.model;
  model.skeleton = skeleton;
  model.skeleton.reference = plan.wanted.empty() ? plan.built : plan.wanted;
  model.positions.resize(mesh.positions.size());
  bind_surface(mesh, blocked, level.smoothing, options.jobs, model);
  map_surface(mesh, blocked, options.jobs, model);
  if (!plan.wanted.empty()) move_to(skeleton, plan.built, plan.wanted, model, mesh);

  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    model.positions[v] = mesh.positions[v].cast<float>();
  }
  for (const Vec3& normal : vertex_normals(mesh)) model.normals.push_back(normal.cast<float>());
  model.triangles = mesh.triangles;
  model.parts = {{"body", "body", 0, static_cast<std::uint32_t>(model.triangles.size())}};
  body.volume = signed_volume(mesh);
  if (Status status = check(model); !status) return std::move(status).error();
  return body;
}

Result<Body> make_body(const Skeleton& skeleton, const BodyOptions& options) {
  Clip clip;
  clip.skeleton = skeleton;
  return make_body(clip, options);
}

}  // namespace krok
