#pragma once

#include <optional>

#include "core/result.h"
#include "formats/csv/series.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/krok-export/options.h"

// The series of --what.

namespace krok::cli::exporting {

// positions, velocities: world, metres and metres per second. local: position and orientation
// relative to the parent. quaternions: world orientations. Velocities are central differences,
// one-sided at both ends.
csv::SeriesTable joint_series(const Clip& clip, What what);

// Anatomical angles in degrees, as krok-plot draws them (draw::body_angle). With `coordinates` the
// names are those of OpenSim's full-body models where they have the angle: hip_flexion_r,
// knee_angle_r, ankle_angle_r, elbow_flex_r. Code export-angles if the skeleton has none.
Result<csv::SeriesTable> angle_series(const Clip& clip, const RoleMap& roles, bool coordinates);

// 1 for each joint in contact in a frame.
csv::SeriesTable contact_series(const Clip& clip, std::span<const Contact> contacts);

}  // namespace krok::cli::exporting
