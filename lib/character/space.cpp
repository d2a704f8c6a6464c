#include "character/space.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/numbers.h"

namespace krok::character {

namespace {

constexpr const char* kFromFile = "specified by the file format or header";

Unit unit_of(double metres) {
  for (const char* name : {"m", "dm", "cm", "mm", "in", "ft"}) {
    const Unit unit = *parse_unit(name);
    if (std::abs(metres / unit.metres - 1) < 1e-6) return unit;
  }
  return {metres, readable(metres) + " m"};
}

Direction nearest(const Vec3& axis) {
  Direction best = Direction::plus_x;
  for (const Direction direction : {Direction::minus_x, Direction::plus_y, Direction::minus_y,
                                    Direction::plus_z, Direction::minus_z}) {
    if (direction_vector(direction).dot(axis) > direction_vector(best).dot(axis)) best = direction;
  }
  return best;
}

void take_axes(const nodes::Space& space, Conventions& found) {
  const bool applied = rotation_to_apply(space) != Mat4::Identity();
  const Quat back = applied ? Quat::Identity() : space.file_to_krok->conjugate();
  found.up = found.reference_up = nearest(back * Vec3::UnitY());
  found.forward = found.reference_forward = nearest(back * Vec3::UnitZ());
  found.up_confidence = found.forward_confidence = Confidence::certain;
  found.up_reason = found.forward_reason = kFromFile;
}

}  // namespace

Mat4 rotation_to_apply(const nodes::Space& space) {
  Mat4 result = Mat4::Identity();
  if (!space.file_to_krok) return result;
  const Mat3 turn = space.file_to_krok->toRotationMatrix();
  const bool by_quarters = (turn - Mat3(turn.array().round())).cwiseAbs().maxCoeff() < 1e-6;
  if (!by_quarters) result.topLeftCorner<3, 3>() = turn;
  return result;
}

Conventions find_conventions(const nodes::Space& space, const Rig* rig, const RoleMap& roles,
                             std::span<const Vec3> samples, const GivenConventions& given) {
  Conventions found;
  const bool all_known =
      (space.metres || given.unit) && (space.file_to_krok || (given.up && given.forward));
  if (!all_known && rig != nullptr) {
    found = detect_conventions(rig->skeleton, roles, samples);
  } else if (!all_known) {
    found.unit_reason = found.up_reason = found.forward_reason =
        "not specified by the file, and there is no character to detect it from";
  }
  if (space.metres) {
    found.unit = unit_of(*space.metres);
    found.unit_confidence = Confidence::certain;
    found.unit_reason = kFromFile;
  }
  if (space.file_to_krok) take_axes(space, found);
  GivenConventions known = given;
  const bool up_from_file = space.up_is_y && !given.up && !space.file_to_krok;
  if (up_from_file) known.up = Direction::plus_y;
  apply_given(known, found);
  if (given.forward && rig != nullptr &&
      detect_conventions(rig->skeleton, roles, samples).forward == *given.forward) {
    found.forward_doubt.clear();  // the file's axes are certain, but its body faces that way
  }
  if (up_from_file) {
    found.up_reason = kFromFile;
    found.up_doubt.clear();
    found.forward_doubt.clear();
  }
  return found;
}

bool is_plausible_size(double size) {
  constexpr double kSmallest = 0.3;
  constexpr double kTallest = 5.0;
  return size >= kSmallest && size <= kTallest;
}

void check_size(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics) {
  constexpr double kLargest = 40;  // metres: a whale has 30
  Eigen::AlignedBox3d box;
  for (const Transform& joint : skeleton.reference) box.extend(joint.position);
  const double size = box.sizes().maxCoeff();
  if (roles.humanoid ? is_plausible_size(size) : size <= kLargest) return;
  diagnostics.push_back(make_warning(
      "scene-unit",
      fmt::format("the character is {} m in size in the file's unit, which is not a plausible "
                  "{}size",
                  readable(size, 3), roles.humanoid ? "human " : ""),
      "krok-import --unit sets another than the file's: mm, cm, in, ft or m"));
}

void check_actor(const Skeleton& skeleton, const RoleMap& roles, Diagnostics& diagnostics) {
  if (!roles.humanoid) return;
  const Conventions found = detect_conventions(skeleton, roles, {});
  if (found.up_confidence != Confidence::guess && found.up != Direction::plus_y) {
    diagnostics.push_back(make_warning(
        "scene-up", fmt::format("the character's up axis is not +y: {}", found.up_reason),
        "if it should be, set the file's up axis with --up"));
  } else if (found.forward_confidence != Confidence::guess && found.forward != Direction::plus_z) {
    diagnostics.push_back(make_warning(
        "scene-forward",
        fmt::format("the character does not face +z: {}; it is not rotated", found.forward_reason),
        fmt::format("krok-import --forward {} rotates it to +z", direction_name(found.forward))));
  }
}

}  // namespace krok::character
