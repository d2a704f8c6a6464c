#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "compare/scene_comparison_internal.h"
#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

// A mesh whose vertices are compared: with those of another by number, or with points of a surface.
struct Part {
  int mesh = -1;
  bool in_second = false;
  int other = -1;
  const std::vector<SurfacePoint>* points = nullptr;
  bool normals = true;  // whether all of those points have normals
};

// What was found of one part at one moment.
struct PartTotals {
  Totals positions, normals;
};

// What belongs to a thread: memory that is used again, and what may be gathered in any order.
struct Slot {
  SceneState first, second;
  std::vector<PartTotals> parts;            // of the moment
  std::vector<double> distances, angles;    // of the moment, [compared joints]
  bool finite = true;                       // of the moment
  std::vector<Spread> positions, normals;   // of all moments, [parts]
  std::vector<std::vector<float>> largest;  // of all moments, as vertex_largest
};

std::vector<Part> parts_of(const SceneComparison& comparison) {
  std::vector<Part> parts;
  for (const auto& [i, j] : comparison.meshes) parts.push_back({i, false, j, nullptr, true});
  for (const SurfaceMatch& one : comparison.surfaces) {
    const auto& meshes = one.in_second ? comparison.first.meshes : comparison.second.meshes;
    const bool normals =
        std::all_of(one.points.begin(), one.points.end(), [&](const SurfacePoint& point) {
          return meshes[static_cast<std::size_t>(point.mesh)].has_normals;
        });
    parts.push_back({one.mesh, one.in_second, -1, &one.points, normals});
  }
  return parts;
}

// Adds up values in order, of vertices from `begin` on.
void gather(std::span<const double> values, std::size_t begin, Place place, Totals& totals,
            Spread& spread) {
  std::size_t worst = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = Totals::finite_or_infinite(values[i]);
    if (value > totals.largest) {
      totals.largest = value;
      worst = i;
    }
    totals.square_sum += value * value;
    totals.over += value > totals.tolerance ? 1 : 0;
    spread.add(value);
  }
  totals.count += static_cast<std::int64_t>(values.size());
  if (worst == values.size()) return;
  place.vertex = static_cast<int>(begin + worst);
  totals.where = place;
}

// Vertices are looked at so many at a time, which stay in the processor's nearest memory.
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
        slots_(slots_for(jobs)) {
    for (Slot& slot : slots_) {
      slot.positions.resize(parts_.size());
      slot.normals.resize(parts_.size());
    }
    SceneDifference& result = comparison.result;
    for (const Part& part : parts_) {
      result.parts.push_back({part.mesh, part.in_second, result.positions, result.normals});
    }
    for (const auto& pair : comparison.joints) {
      result.joints.push_back({pair.first, result.joint_positions, result.joint_orientations});
    }
  }

  Status run(int jobs) {
    const auto& moments = comparison_.moments;
    comparison_.result.moments.reserve(moments.size());
    progress_.begin("comparing", moments.size());
    const Status done = make_in_order(
        moments.size(), jobs,
        [&](std::size_t item, std::size_t slot) { return measure(moments[item], slots_[slot]); },
        [&](std::size_t item, std::size_t slot) { return take(moments[item], slots_[slot]); });
    if (!done) return done;
    progress_.end();
    finish();
    return {};
  }

 private:
  std::vector<std::vector<float>> no_vertices() const;
  Status measure(const Moment& moment, Slot& slot) const;
  void measure_part(std::size_t index, Place place, Slot& slot) const;
  Status take(const Moment& moment, Slot& slot);
  MomentDifference take_parts(const Slot& slot);
  void take_joints(Place place, const Slot& slot, MomentDifference& moment);
  void finish();
  Place place_of(const Moment& moment) const {
    return {.animation = comparison_.first.animations.size() > 1 ? moment.first_animation : -1,
            .frame = moment.frame,
            .time = moment.first_time};
  }

  SceneComparison& comparison_;
  Progress& progress_;
  const std::vector<Part> parts_;
  std::vector<Slot> slots_;
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
  const SceneDifference& result = comparison_.result;
  slot.parts.assign(parts_.size(),
                    {Totals(result.positions.tolerance), Totals(result.normals.tolerance)});
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

void Measuring::measure_part(std::size_t index, Place place, Slot& slot) const {
  const Part& part = parts_[index];
  place.mesh = part.mesh;
  place.in_second = part.in_second;
  const auto mesh = static_cast<std::size_t>(part.mesh);
  const SceneState& own = part.in_second ? slot.second : slot.first;
  const SceneState& other = part.in_second ? slot.first : slot.second;
  float* largest = slot.largest.empty() || part.in_second ? nullptr : slot.largest[mesh].data();
  Totals& positions = slot.parts[index].positions;
  const auto add_positions = [&](std::size_t begin, std::span<const double> values) {
    gather(values, begin, place, positions, slot.positions[index]);
    for (std::size_t i = 0; largest != nullptr && i < values.size(); ++i) {
      largest[begin + i] = std::max(largest[begin + i], static_cast<float>(values[i]));
    }
  };
  const auto add_normals = [&](std::size_t begin, std::span<const double> values) {
    gather(values, begin, place, slot.parts[index].normals, slot.normals[index]);
  };
  const Points& a = own.positions[mesh];
  const Points& normals = own.normals[mesh];
  if (part.points != nullptr) {
    const auto& points = *part.points;
    in_blocks(
        a.size(),
        [&](std::size_t i) { return (a[i] - value_at(points[i], other.positions)).norm(); },
        add_positions);
    if (!normals.empty() && part.normals) {
      in_blocks(
          normals.size(),
          [&](std::size_t i) {
            return angle_between_directions(normals[i], value_at(points[i], other.normals));
          },
          add_normals);
    }
  } else {
    const Points& b = other.positions[static_cast<std::size_t>(part.other)];
    const Points& other_normals = other.normals[static_cast<std::size_t>(part.other)];
    in_blocks(
        a.size(), [&](std::size_t i) { return (a[i] - b[i]).norm(); }, add_positions);
    if (!normals.empty() && !other_normals.empty()) {
      in_blocks(
          normals.size(),
          [&](std::size_t i) { return angle_between_units(normals[i], other_normals[i]); },
          add_normals);
    }
  }
  slot.finite = slot.finite && std::isfinite(positions.largest);
}

MomentValue value_of(const Totals& totals) {
  return {static_cast<float>(totals.largest), static_cast<float>(totals.rms()), totals.where.mesh,
          std::max(totals.where.vertex, totals.where.joint), totals.where.in_second};
}

Status Measuring::take(const Moment& moment, Slot& slot) {
  if (!slot.finite) {
    return Error("compare-value", "a scene gives positions that are not finite numbers",
                 "its nodes or keys hold values that are too large");
  }
  MomentDifference found = take_parts(slot);
  take_joints(place_of(moment), slot, found);
  found.animation = moment.first_animation;
  found.frame = moment.frame;
  found.time = moment.first_time;
  comparison_.result.moments.push_back(found);
  progress_.advance(1);
  return {};
}

MomentDifference Measuring::take_parts(const Slot& slot) {
  SceneDifference& result = comparison_.result;
  Totals positions(result.positions.tolerance);
  Totals normals(result.normals.tolerance);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    positions.merge(slot.parts[i].positions);
    normals.merge(slot.parts[i].normals);
    result.parts[i].positions.Totals::merge(slot.parts[i].positions);
    result.parts[i].normals.Totals::merge(slot.parts[i].normals);
  }
  result.positions.Totals::merge(positions);
  result.normals.Totals::merge(normals);
  MomentDifference found;
  found.positions = value_of(positions);
  found.normals = value_of(normals);
  return found;
}

void Measuring::take_joints(Place place, const Slot& slot, MomentDifference& moment) {
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

// Puts together what the slots have gathered, and the parts' and joints' spreads to those of all.
void Measuring::finish() {
  SceneDifference& result = comparison_.result;
  for (const Slot& slot : slots_) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      result.parts[i].positions.spread.merge(slot.positions[i]);
      result.parts[i].normals.spread.merge(slot.normals[i]);
    }
  }
  for (const PartDifference& part : result.parts) {
    result.positions.spread.merge(part.positions.spread);
    result.normals.spread.merge(part.normals.spread);
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
  if (Status done = measuring.run(jobs); !done) return done;
  comparison.result.compared_times = static_cast<int>(comparison.moments.size());
  return {};
}

}  // namespace krok::compare
