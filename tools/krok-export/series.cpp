#include "tools/krok-export/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "draw/joint_angles.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"

namespace krok::cli::exporting {

namespace {

csv::SeriesTable table_of(const Clip& clip, std::string item_name, std::vector<std::string> items,
                          std::vector<std::string> quantities) {
  csv::SeriesTable table;
  table.rate = clip.rate;
  table.frames = clip.frame_count();
  table.item_name = std::move(item_name);
  table.items = std::move(items);
  table.quantities = std::move(quantities);
  table.values.reserve(static_cast<std::size_t>(table.frames) * table.columns());
  return table;
}

void add(const Vec3f& vector, csv::SeriesTable& table) {
  table.values.insert(table.values.end(), vector.data(), vector.data() + 3);
}

// In the hemisphere of the one before, of a joint; the first with w >= 0.
void add(Quat orientation, Quat& before, csv::SeriesTable& table) {
  const bool first = before.coeffs().isZero(0);
  if (first ? orientation.w() < 0 : before.dot(orientation) < 0) orientation.coeffs() *= -1;
  before = orientation;
  for (int k = 0; k < 4; ++k) {
    table.values.push_back(static_cast<float>(orientation.coeffs()[k]));
  }
}

std::vector<Quat> none_before(const Clip& clip) {
  return std::vector<Quat>(static_cast<std::size_t>(clip.joint_count()), Quat(0, 0, 0, 0));
}

void add_velocities(const Clip& clip, csv::SeriesTable& table) {
  const int last = clip.frame_count() - 1;
  for (int f = 0; f <= last; ++f) {
    const int before = std::max(f - 1, 0), after = std::min(f + 1, last);
    const auto from = clip.frame_positions(before), to = clip.frame_positions(after);
    const double per_second = after > before ? clip.rate / (after - before) : 0;
    for (std::size_t j = 0; j < from.size(); ++j) {
      const Vec3 way = to[j].cast<double>() - from[j].cast<double>();
      add(Vec3f((per_second * way).cast<float>()), table);
    }
  }
}

void add_locals(const Clip& clip, csv::SeriesTable& table) {
  const LocalMotion local = local_motion(clip);
  std::vector<Quat> before = none_before(clip);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const Transform at = local.at(j, f);
      add(Vec3f(at.position.cast<float>()), table);
      add(normalized_or_identity(at.orientation), before[static_cast<std::size_t>(j)], table);
    }
  }
}

struct AngleName {
  draw::BodyAngle angle;
  const char* name;
  const char* coordinate;  // of OpenSim
};
constexpr std::array kAngles = {
    AngleName{draw::BodyAngle::hip, "hip_flexion", "hip_flexion"},
    AngleName{draw::BodyAngle::knee, "knee_flexion", "knee_angle"},
    AngleName{draw::BodyAngle::ankle, "ankle_dorsiflexion", "ankle_angle"},
    AngleName{draw::BodyAngle::shoulder, "shoulder_elevation", "shoulder_elevation"},
    AngleName{draw::BodyAngle::elbow, "elbow_flexion", "elbow_flex"}};

}  // namespace

csv::SeriesTable joint_series(const Clip& clip, What what) {
  const auto make = [&](std::vector<std::string> quantities) {
    return table_of(clip, "joint", clip.skeleton.names, std::move(quantities));
  };
  csv::SeriesTable table;
  switch (what) {
    case What::velocities:
      table = make({"vx", "vy", "vz"});
      add_velocities(clip, table);
      break;
    case What::local:
      table = make({"x", "y", "z", "qx", "qy", "qz", "qw"});
      add_locals(clip, table);
      break;
    case What::quaternions: {
      table = make({"qx", "qy", "qz", "qw"});
      std::vector<Quat> before = none_before(clip);
      for (int f = 0; f < clip.frame_count(); ++f) {
        const auto orientations = clip.frame_orientations(f);
        for (std::size_t j = 0; j < orientations.size(); ++j) {
          add(normalized_or_identity(orientations[j].cast<double>()), before[j], table);
        }
      }
      break;
    }
    case What::automatic:
    case What::positions:
    case What::angles:
    case What::contacts:
      table = make({"x", "y", "z"});
      for (int f = 0; f < clip.frame_count(); ++f) {
        for (const Vec3f& place : clip.frame_positions(f)) add(place, table);
      }
      break;
  }
  return table;
}

Result<csv::SeriesTable> angle_series(const Clip& clip, const RoleMap& roles, bool coordinates) {
  if (clip.frame_count() == 0) return Error("export-angles", "the motion has no frames");
  std::vector<std::string> names;
  std::vector<std::vector<double>> series;
  const draw::FrameRange frames{0, clip.frame_count() - 1};
  for (const AngleName& angle : kAngles) {
    for (const Side side : {Side::left, Side::right}) {
      auto values = draw::body_angle(clip, roles, angle.angle, side, frames);
      if (values.empty()) continue;
      names.push_back(fmt::format("{}_{}", coordinates ? angle.coordinate : angle.name,
                                  side == Side::left ? "l" : "r"));
      series.push_back(std::move(values));
    }
  }
  if (names.empty()) {
    return Error("export-angles", "the skeleton has no joints with roles for body angles",
                 "--map assigns joint roles; --what local has the rotations of all joints");
  }
  csv::SeriesTable table = table_of(clip, "angle", std::move(names), {"degrees"});
  for (std::size_t f = 0; f < static_cast<std::size_t>(table.frames); ++f) {
    for (const auto& values : series) table.values.push_back(static_cast<float>(values[f]));
  }
  return table;
}

csv::SeriesTable contact_series(const Clip& clip, std::span<const Contact> contacts) {
  std::set<int> touching;
  for (const Contact& contact : contacts) touching.insert(contact.joint);
  std::vector<std::string> names;
  for (const int joint : touching) {
    names.push_back(clip.skeleton.names[static_cast<std::size_t>(joint)]);
  }
  csv::SeriesTable table = table_of(clip, "joint", std::move(names), {"contact"});
  for (int f = 0; f < table.frames; ++f) {
    const double time = f / clip.rate;
    for (const int joint : touching) {
      const bool down = std::ranges::any_of(contacts, [&](const Contact& contact) {
        return contact.joint == joint && contact.start <= time && time <= contact.end;
      });
      table.values.push_back(down ? 1.0F : 0.0F);
    }
  }
  return table;
}

}  // namespace krok::cli::exporting
