#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "capture/actor_internal.h"

namespace krok::actor {

namespace {

struct UnitCandidate {
  const char* name;
  double rarity;  // penalty, added to |ln(height / usual height)|
};
constexpr std::array kUnitCandidates = {UnitCandidate{"m", 0.0},   UnitCandidate{"cm", 0.0},
                                        UnitCandidate{"mm", 0.05}, UnitCandidate{"in", 0.1},
                                        UnitCandidate{"cmu", 0.1}, UnitCandidate{"dm", 0.15},
                                        UnitCandidate{"ft", 0.15}};

Unit unit_named(const char* name) {
  return *parse_unit(name);
}

// Whether a captured subject can have that size.
bool is_sensible(double metres) {
  return metres >= 0.01 && metres <= 1000.0;
}

void detect_unit_of_actor(const Stature& stature, bool cmu_names, Conventions& found) {
  const double height = stature.metres;
  constexpr double kUsualHeight = 1.72;
  double best = INFINITY;
  double second = INFINITY;
  for (const UnitCandidate& candidate : kUnitCandidates) {
    const Unit unit = unit_named(candidate.name);
    const double score = std::abs(std::log(height * unit.metres / kUsualHeight)) + candidate.rarity;
    if (score < best) {
      second = best;
      best = score;
      found.unit = unit;
    } else {
      second = std::min(second, score);
    }
  }
  const double metres = height * found.unit.metres;
  // Where segments disagree, so do the units that they would give.
  const double doubt = std::min(stature.uncertainty / height, 1.0);
  const double margin = second - best;
  // A height that only a rare unit explains may come from any scale.
  const bool usual = found.unit.name == "m" || found.unit.name == "cm" || found.unit.name == "mm";
  if (usual && metres >= 1.45 && metres <= 2.1 && margin > 0.3 + doubt) {
    found.unit_confidence = Confidence::certain;
  } else if (metres >= 1.25 && metres <= 2.4 && margin > 0.3) {
    found.unit_confidence = Confidence::likely;
  }
  if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "the character would be {:.3g} m tall; no common unit gives a plausible height", metres);
    return;
  }
  found.unit_reason = fmt::format("bone lengths fit a person {:.2f} m tall, within {:.2f} m",
                                  metres, stature.uncertainty * found.unit.metres);
  if (found.unit.name == "cmu" && cmu_names && metres > 1.2 && metres < 2.2) {
    found.unit_confidence = Confidence::certain;
    found.unit_reason += ", with the joint names of the CMU collection";
  }
  if (found.unit_confidence == Confidence::guess) {
    found.unit_reason += "; no common unit is a clear match";
  }
}

// The largest extent over the axes of the reference pose and of each sample.
double largest_extent(const Evidence& evidence) {
  const auto extent = [](Positions pose) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : pose) {
      if (p.allFinite()) box.extend(p);
    }
    return box.isEmpty() ? 0.0 : box.sizes().maxCoeff();
  };
  double largest = extent(evidence.reference);
  for (std::size_t i = 0; i < evidence.sample_count; ++i) {
    largest = std::max(largest, extent(evidence.sample(i)));
  }
  return largest;
}

// Helper joints that are nearly unique to the CMU collection's skeletons.
bool has_cmu_names(const Skeleton& skeleton) {
  const bool lower_back = skeleton.find("LowerBack") >= 0 || skeleton.find("lowerback") >= 0;
  return lower_back && (skeleton.find("LHipJoint") >= 0 || skeleton.find("lhipjoint") >= 0);
}

}  // namespace

void detect_unit(const Evidence& evidence, Conventions& found) {
  if (const auto stature = stature_of(evidence)) {
    return detect_unit_of_actor(*stature, has_cmu_names(evidence.skeleton), found);
  }
  const double extent = largest_extent(evidence);
  constexpr double kLargest = 10.0;  // metres
  for (const char* name : {"m", "cm", "mm"}) {
    found.unit = unit_named(name);
    if (extent * found.unit.metres <= kLargest) break;
  }
  const double metres = extent * found.unit.metres;
  if (!(extent > 0)) {
    found.unit_reason = "all joints coincide, so the size is unknown";
  } else if (!is_sensible(metres)) {
    found.unit_reason = fmt::format(
        "no legs or arms to measure, and none of m, cm and mm gives a plausible size; in {} it "
        "would be {:.3g} m",
        found.unit.name, metres);
  } else {
    found.unit_reason =
        fmt::format("no legs or arms to measure; a size of {:.3g} m is assumed plausible", metres);
  }
}

}  // namespace krok::actor
