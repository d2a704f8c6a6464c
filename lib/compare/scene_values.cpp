#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "compare/mesh_difference.h"
#include "compare/scene_comparison_internal.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

// A mesh whose vertices are compared: by index with another mesh, or with points of a surface.
struct Part {
  int mesh = -1;
  bool in_second = false;
  int other = -1;
  const std::vector<SurfacePoint>* points = nullptr;  // for positions
  const std::vector<SurfacePoint>* fits = nullptr;    // for normals and tangents
  // Whether both have them; for a surface, whether all matched points do.
  bool normals = true;
  bool tangents = false;
};

// Quantities measured per vertex, and where they are accumulated.
enum Quantity : std::size_t { kPositions, kNormals, kTangents, kTangentSides, kQuantities };
constexpr std::array<Measure SceneDifference::*, kQuantities> kOfScene = {
    &SceneDifference::positions, &SceneDifference::normals, &SceneDifference::tangents,
    &SceneDifference::tangent_sides};
constexpr std::array<Measure PartDifference::*, kQuantities> kOfPart = {
    &PartDifference::positions, &PartDifference::normals, &PartDifference::tangents,
    &PartDifference::tangent_sides};

using PartTotals = std::array<Totals, kQuantities>;   // of one part at one moment
using PartSpreads = std::array<Spread, kQuantities>;  // of one part at all moments

// Per-thread data: reusable memory, and results that can be accumulated in any order.
struct Slot {
  SceneState first, second;
  std::vector<PartTotals> parts;            // of the moment
  std::vector<double> distances, angles;    // of the moment, [compared joints]
  bool finite = true;                       // of the moment
  std::vector<PartSpreads> spreads;         // of all moments, [parts]
  std::vector<std::vector<float>> largest;  // of all moments, as vertex_largest
};

std::vector<Part> parts_of(const SceneComparison& comparison) {
  std::vector<Part> parts;
  const auto mesh = [](const Scene& scene, int index) -> const SceneMesh& {
    return scene.meshes[static_cast<std::size_t>(index)];
  };
  for (const auto& [i, j] : comparison.meshes) {
    const bool tangents =
        mesh(comparison.first, i).has_tangents && mesh(comparison.second, j).has_tangents;
    parts.push_back({i, false, j, nullptr, nullptr, true, tangents});
  }
  for (const SurfaceMatch& one : comparison.surfaces) {
    const Scene& own = one.in_second ? comparison.second : comparison.first;
    const Scene& other = one.in_second ? comparison.first : comparison.second;
    const auto all_have = [&](bool SceneMesh::*what) {
      return std::all_of(one.fits.begin(), one.fits.end(), [&](const SurfacePoint& point) {
        return point.mesh < 0 || mesh(other, point.mesh).*what;
      });
    };
    const bool tangents = mesh(own, one.mesh).has_tangents && all_have(&SceneMesh::has_tangents);
    parts.push_back({one.mesh, one.in_second, -1, &one.points, &one.fits,
                     all_have(&SceneMesh::has_normals), tangents});
  }
  return parts;
}

// Accumulates values in order, for vertices from `begin` on.
void gather(std::span<const double> values, std::size_t begin, ValueLocation place, Totals& totals,
            Spread& spread) {
  std::size_t worst = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = Totals::finite_or_infinite(values[i]);
    if (value > totals.largest) {
      totals.largest = value;
      worst = i;
    }
    totals.sum += value;
    totals.square_sum += value * value;
    totals.over += value > totals.tolerance ? 1 : 0;
    spread.add(value);
  }
  totals.count += static_cast<std::int64_t>(values.size());
  if (worst == values.size()) return;
  place.vertex = static_cast<int>(begin + worst);
  totals.where = place;
}

// Vertices are processed in blocks that fit into the L1 cache.
constexpr std::size_t kBlock = 1024;

// Calls with(begin, values) for each block of `count` values, filled by find(i).
template <typename Find, typename With>
void in_blocks(std::size_t count, const Find& find, const With& with) {
  std::array<double, kBlock> values;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t size = std::min(kBlock, count - begin);
    for (std::size_t i = 0; i < size; ++i) values[i] = find(begin + i);
    with(begin, std::span<const double>(values.data(), size));
  }
}

// Tangent directions and handedness; gatherer(quantity) accepts blocks of values.
template <typename Gatherer>
void measure_tangents(const Part& part, const SceneState& own, const SceneState& other,
                      const Gatherer& gatherer) {
  const std::vector<Vec4>& tangents = own.tangents[static_cast<std::size_t>(part.mesh)];
  const auto partner_of = [&](std::size_t i) -> Vec4 {
    if (part.fits != nullptr && (*part.fits)[i].mesh < 0) return tangents[i];
    return part.fits != nullptr ? value_at((*part.fits)[i], other.tangents)
                                : other.tangents[static_cast<std::size_t>(part.other)][i];
  };
  in_blocks(
      tangents.size(),
      [&](std::size_t i) {
        const Vec4 partner = partner_of(i);
        const Vec3 a = tangents[i].head<3>(), b = partner.head<3>();
        return part.points != nullptr ? angle_between_directions(a, b) : angle_between_units(a, b);
      },
      gatherer(kTangents));
  in_blocks(
      tangents.size(),
      [&](std::size_t i) { return on_other_sides(tangents[i], partner_of(i)) ? 1.0 : 0.0; },
      gatherer(kTangentSides));
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

class Measuring {
 public:
  Measuring(SceneComparison& comparison, int jobs, Progress& progress)
      : comparison_(comparison),
        progress_(progress),
        parts_(parts_of(comparison)),
        slots_(slots_for(jobs)),
        turned_(parts_.size(), false) {
    for (Slot& slot : slots_) slot.spreads.resize(parts_.size());
    SceneDifference& result = comparison.result;
    for (const Part& part : parts_) {
      result.parts.push_back({part.mesh, part.in_second, result.positions, result.normals,
                              result.tangents, result.tangent_sides});
    }
    for (const auto& pair : comparison.joints) {
      result.joints.push_back({pair.first, result.joint_positions, result.joint_orientations});
    }
  }

  Status run(int jobs) {
    const auto& moments = comparison_.moments;
    comparison_.result.moments.reserve(moments.size());
    progress_.begin("comparing", moments.size());
    const Status status = make_in_order(
        moments.size(), jobs,
        [&](std::size_t item, std::size_t slot) { return measure(moments[item], slots_[slot]); },
        [&](std::size_t item, std::size_t slot) { return take(moments[item], slots_[slot]); });
    if (!status) return status;
    progress_.end();
    finish();
    return {};
  }

 private:
  std::vector<std::vector<float>> no_vertices() const;
  Status measure(const Moment& moment, Slot& slot) const;
  PartTotals no_totals() const;
  void measure_part(std::size_t index, ValueLocation place, Slot& slot) const;
  Status take(const Moment& moment, Slot& slot);
  void take_windings(const Moment& moment, const Slot& slot);
  MomentDifference take_parts(const Slot& slot);
  void take_joints(ValueLocation place, const Slot& slot, MomentDifference& moment);
  void finish();
  ValueLocation place_of(const Moment& moment) const {
    return {.animation = comparison_.first.animations.size() > 1 ? moment.first_animation : -1,
            .frame = moment.frame,
            .after_frame = moment.after_frame,
            .time = moment.first_time};
  }

  SceneComparison& comparison_;
  Progress& progress_;
  const std::vector<Part> parts_;
  std::vector<Slot> slots_;
  std::vector<bool> turned_;  // [parts], reported already
};

std::vector<std::vector<float>> Measuring::no_vertices() const {
  std::vector<std::vector<float>> largest;
  if (!comparison_.options.keep_vertices) return largest;
  largest.resize(comparison_.first.meshes.size());
  for (const Part& part : parts_) {
    if (part.in_second) continue;
    const auto mesh = static_cast<std::size_t>(part.mesh);
    largest[mesh].assign(comparison_.first.meshes[mesh].vertex_count, 0.0F);
  }
  return largest;
}

Status Measuring::measure(const Moment& moment, Slot& slot) const {
  comparison_.first.evaluate(moment.first_animation, moment.first_time, slot.first);
  comparison_.second.evaluate(moment.second_animation, moment.second_time, slot.second);
  slot.finite = true;
  if (slot.largest.empty()) slot.largest = no_vertices();
  slot.parts.assign(parts_.size(), no_totals());
  for (std::size_t i = 0; i < parts_.size(); ++i) measure_part(i, place_of(moment), slot);
  slot.distances.clear();
  slot.angles.clear();
  for (const auto& [i, j] : comparison_.joints) {
    const Transform& a = slot.first.joints[static_cast<std::size_t>(i)];
    const Transform& b = slot.second.joints[static_cast<std::size_t>(j)];
    slot.distances.push_back((a.position - b.position).norm());
    slot.angles.push_back(angle_between(a.orientation, b.orientation));
  }
  slot.finite = slot.finite && all_finite(slot.distances);
  return {};
}

PartTotals Measuring::no_totals() const {
  PartTotals totals;
  for (std::size_t q = 0; q < kQuantities; ++q) {
    totals[q] = Totals((comparison_.result.*kOfScene[q]).tolerance);
  }
  return totals;
}

void Measuring::measure_part(std::size_t index, ValueLocation place, Slot& slot) const {
  const Part& part = parts_[index];
  place.mesh = part.mesh;
  place.in_second = part.in_second;
  const auto mesh = static_cast<std::size_t>(part.mesh);
  const auto partner = static_cast<std::size_t>(part.other);
  const SceneState& own = part.in_second ? slot.second : slot.first;
  const SceneState& other = part.in_second ? slot.first : slot.second;
  float* largest = slot.largest.empty() || part.in_second ? nullptr : slot.largest[mesh].data();
  const auto gatherer = [&](Quantity quantity) {
    return [&, quantity](std::size_t begin, std::span<const double> values) {
      gather(values, begin, place, slot.parts[index][quantity], slot.spreads[index][quantity]);
      for (std::size_t i = 0; quantity == kPositions && largest != nullptr && i < values.size();
           ++i) {
        largest[begin + i] = std::max(largest[begin + i], static_cast<float>(values[i]));
      }
    };
  };
  const Points& a = own.positions[mesh];
  const Points& normals = own.normals[mesh];
  if (part.points != nullptr) {
    const auto& points = *part.points;
    in_blocks(
        a.size(),
        [&](std::size_t i) {
          if (points[i].mesh < 0) return 0.0;
          return (a[i] - value_at(points[i], other.positions)).norm();
        },
        gatherer(kPositions));
    if (!normals.empty() && part.normals) {
      in_blocks(
          normals.size(),
          [&](std::size_t i) {
            const SurfacePoint& point = (*part.fits)[i];
            if (point.mesh < 0) return 0.0;
            return angle_between_directions(normals[i], value_at(point, other.normals));
          },
          gatherer(kNormals));
    }
  } else {
    const Points& b = other.positions[partner];
    const Points& other_normals = other.normals[partner];
    in_blocks(
        a.size(), [&](std::size_t i) { return (a[i] - b[i]).norm(); }, gatherer(kPositions));
    if (!normals.empty() && !other_normals.empty()) {
      in_blocks(
          normals.size(),
          [&](std::size_t i) { return angle_between_units(normals[i], other_normals[i]); },
          gatherer(kNormals));
    }
  }
  if (part.tangents) measure_tangents(part, own, other, gatherer);
  slot.finite = slot.finite && std::isfinite(slot.parts[index][kPositions].largest);
}

MomentValue value_of(const Totals& totals) {
  return {static_cast<float>(totals.largest), static_cast<float>(totals.rms()), totals.where.mesh,
          std::max(totals.where.vertex, totals.where.joint), totals.where.in_second};
}

Status Measuring::take(const Moment& moment, Slot& slot) {
  if (!slot.finite) {
    return Error("compare-value", "a scene has positions that are NaN or infinite",
                 "its nodes or keys have values that are too large");
  }
  take_windings(moment, slot);
  MomentDifference found = take_parts(slot);
  take_joints(place_of(moment), slot, found);
  found.animation = moment.first_animation;
  found.frame = moment.frame;
  found.time = moment.first_time;
  comparison_.result.moments.push_back(found);
  progress_.advance(1);
  return {};
}

// Meshes face the same way at the first moment, or their difference was reported; this is about
// nodes that begin to mirror later.
void Measuring::take_windings(const Moment& moment, const Slot& slot) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    if (part.points != nullptr || turned_[i]) continue;
    const SceneMesh& mesh = comparison_.first.meshes[static_cast<std::size_t>(part.mesh)];
    const int begin = winding_of(comparison_.first_placement.windings, part.mesh) *
                      winding_of(comparison_.second_placement.windings, part.other);
    const int now =
        winding_of(slot.first.windings, part.mesh) * winding_of(slot.second.windings, part.other);
    if (begin * now >= 0 || mesh.triangles.empty()) continue;
    turned_[i] = true;
    comparison_.say(fmt::format("{}: turned inside out in only one of the two at {} s",
                                label("mesh", mesh.name, part.mesh),
                                readable(moment.first_time, 4)));
  }
}

MomentDifference Measuring::take_parts(const Slot& slot) {
  SceneDifference& result = comparison_.result;
  PartTotals all = no_totals();
  for (std::size_t q = 0; q < kQuantities; ++q) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      all[q].merge(slot.parts[i][q]);
      (result.parts[i].*kOfPart[q]).Totals::merge(slot.parts[i][q]);
    }
    (result.*kOfScene[q]).Totals::merge(all[q]);
  }
  MomentDifference found;
  found.positions = value_of(all[kPositions]);
  found.normals = value_of(all[kNormals]);
  found.tangents = value_of(all[kTangents]);
  return found;
}

void Measuring::take_joints(ValueLocation place, const Slot& slot, MomentDifference& moment) {
  SceneDifference& result = comparison_.result;
  Totals positions(result.joint_positions.tolerance);
  Totals orientations(result.joint_orientations.tolerance);
  for (std::size_t k = 0; k < comparison_.joints.size(); ++k) {
    place.joint = comparison_.joints[k].first;
    positions.add(slot.distances[k], place);
    orientations.add(slot.angles[k], place);
    result.joints[k].positions.add(slot.distances[k], place);
    result.joints[k].orientations.add(slot.angles[k], place);
  }
  result.joint_positions.Totals::merge(positions);
  result.joint_orientations.Totals::merge(orientations);
  moment.joint_positions = value_of(positions);
  moment.joint_orientations = value_of(orientations);
}

// Merges the results of all slots, and the spreads of parts and joints into the totals.
void Measuring::finish() {
  SceneDifference& result = comparison_.result;
  for (const Slot& slot : slots_) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (std::size_t q = 0; q < kQuantities; ++q) {
        (result.parts[i].*kOfPart[q]).spread.merge(slot.spreads[i][q]);
      }
    }
  }
  for (const PartDifference& part : result.parts) {
    for (std::size_t q = 0; q < kQuantities; ++q) {
      (result.*kOfScene[q]).spread.merge((part.*kOfPart[q]).spread);
    }
  }
  for (const JointDifference& joint : result.joints) {
    result.joint_positions.spread.merge(joint.positions.spread);
    result.joint_orientations.spread.merge(joint.orientations.spread);
  }
  result.vertex_largest = no_vertices();
  for (const Slot& slot : slots_) {
    for (std::size_t mesh = 0; mesh < slot.largest.size(); ++mesh) {
      std::vector<float>& all = result.vertex_largest[mesh];
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::max(all[i], slot.largest[mesh][i]);
    }
  }
}

}  // namespace

Status compare_moments(SceneComparison& comparison, int jobs, Progress& progress) {
  Measuring measuring(comparison, jobs, progress);
  if (Status status = measuring.run(jobs); !status) return status;
  comparison.result.compared_times = static_cast<int>(comparison.moments.size());
  return {};
}

}  // namespace krok::compare
