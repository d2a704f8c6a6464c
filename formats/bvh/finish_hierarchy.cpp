#include "formats/bvh/hierarchy.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::bvh {

namespace {

// Limits the number of messages.
constexpr int kMaxWarnings = 20;

}  // namespace

void report_in_file(Severity severity, std::string code, std::string message,
                    const std::string& file_name, Diagnostics& diagnostics) {
  Error diagnostic = Error(std::move(code), std::move(message)).in_file(file_name);
  diagnostic.severity = severity;
  diagnostics.push_back(std::move(diagnostic));
}

Status check_channels(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics) {
  bool any = false;
  bool positions = false;
  for (const Channel& channel : hierarchy.channels) {
    any = any || channel.kind != ChannelKind::ignored;
    positions = positions || channel.kind == ChannelKind::position;
  }
  if (!any && !hierarchy.channels.empty()) {
    return Error("bvh-channels",
                 fmt::format("none of the {} channels is a position or a rotation",
                             hierarchy.channels.size()),
                 "channels are named Xposition .. Zrotation");
  }
  if (any && !positions) {
    report_in_file(Severity::note, "bvh-channels",
                   "no joint has position channels: the motion is in place", file_name,
                   diagnostics);
  }
  return {};
}

void join_roots(Hierarchy& hierarchy, std::vector<std::size_t>& name_places,
                const std::string& file_name, Diagnostics& diagnostics) {
  std::size_t roots = 0;
  for (const auto& joint : hierarchy.joints) roots += joint.parent < 0 ? 1 : 0;
  if (roots == 1) return;
  Hierarchy::Joint parent;
  parent.name = "Roots";
  hierarchy.joints.insert(hierarchy.joints.begin(), parent);
  name_places.insert(name_places.begin(), 0);
  for (std::size_t i = 1; i < hierarchy.joints.size(); ++i) ++hierarchy.joints[i].parent;
  for (Channel& channel : hierarchy.channels) ++channel.joint;
  report_in_file(
      Severity::warning, "bvh-roots",
      fmt::format("the file has {} ROOTs; a common parent joint is added at the origin", roots),
      file_name, diagnostics);
}

void name_joints(Hierarchy& hierarchy, std::span<const std::size_t> name_places,
                 std::string_view text, const std::string& file_name, Diagnostics& diagnostics) {
  std::vector<Hierarchy::Joint>& joints = hierarchy.joints;
  Locator locate(text, file_name);
  int duplicates = 0;
  int recoded = 0;
  int cleaned = 0;
  int nameless = 0;
  const auto warn = [&](std::size_t joint, const char* code, std::string message) {
    Diagnostic warning = make_warning(code, std::move(message));
    warning.where = locate(name_places[joint]);
    warning.joint = joints[joint].name;
    diagnostics.push_back(std::move(warning));
  };

  UniqueNames names;
  std::vector<std::size_t> renamed;
  // Claims names from the file first, so that a generated name never displaces one of them.
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].end_site) continue;
    std::string& name = joints[i].name;
    if (!is_utf8(name)) {
      name = to_utf8(name);
      if (++recoded <= kMaxWarnings) {
        warn(i, "bvh-name",
             fmt::format("the name of joint {} is not UTF-8 and was read as Latin-1", name));
      }
    }
    std::string cleaned_name = readable_joint_name(name);
    if (cleaned_name != name) {
      name = std::move(cleaned_name);
      if (++cleaned <= kMaxWarnings) {
        warn(i, "bvh-name",
             fmt::format("a joint name has control characters; renamed to {}", name));
      }
    }
    if (name.empty() || !names.claim(name)) renamed.push_back(i);
  }
  for (const std::size_t i : renamed) {
    std::string& name = joints[i].name;
    const std::string given = name;
    name = names.make(given.empty() ? "joint" : given);
    if (given.empty() && ++nameless <= kMaxWarnings) {
      warn(i, "bvh-name", fmt::format("a joint without a name is named {}", name));
    }
    if (!given.empty() && ++duplicates <= kMaxWarnings) {
      warn(i, "bvh-name-duplicate",
           fmt::format("duplicate joint name {}; renamed to {}", given, name));
    }
  }
  if (duplicates > kMaxWarnings) {
    diagnostics.push_back(
        make_warning("bvh-name-duplicate",
                     fmt::format("{} with a duplicate name",
                                 counted(duplicates - kMaxWarnings, "more joint", "more joints")),
                     "", file_name));
  }
  for (auto& joint : joints) {
    if (!joint.end_site) continue;
    joint.name = names.make(joints[static_cast<std::size_t>(joint.parent)].name + "_end");
  }
}

void report_zero_bones(const Hierarchy& hierarchy, const std::string& file_name,
                       Diagnostics& diagnostics) {
  int zero = 0;
  std::string first;
  for (const auto& joint : hierarchy.joints) {
    if (joint.parent < 0 || joint.end_site || !joint.offset.isZero(0)) continue;
    if (zero++ == 0) first = joint.name;
  }
  if (zero == 0) return;
  report_in_file(Severity::note, "bvh-zero-bones",
                 fmt::format("{} joint{} at the position of {} parent (the first: {})", zero,
                             zero == 1 ? " is" : "s are", zero == 1 ? "its" : "their", first),
                 file_name, diagnostics);
}

void report_long_ends(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics) {
  constexpr int kWholeBody = 15;    // joints
  constexpr double kTooLong = 0.5;  // of the skeleton's extent without its end sites
  Eigen::AlignedBox3d box;
  std::vector<Vec3> places;
  int joints = 0;
  for (const auto& joint : hierarchy.joints) {
    const Vec3 above =
        joint.parent < 0 ? Vec3(Vec3::Zero()) : places[static_cast<std::size_t>(joint.parent)];
    // The root's offset only places the body.
    places.push_back(joint.parent < 0 ? Vec3(Vec3::Zero()) : Vec3(above + joint.offset));
    if (joint.end_site) continue;
    box.extend(places.back());
    ++joints;
  }
  if (joints < kWholeBody) return;
  for (const auto& joint : hierarchy.joints) {
    const double length = joint.offset.norm();
    if (!joint.end_site || !(length > kTooLong * box.sizes().maxCoeff())) continue;
    report_in_file(Severity::warning, "bvh-end-site",
                   fmt::format("the End Site of {} is {} away, more than half of the character's "
                               "size of {}",
                               hierarchy.joints[static_cast<std::size_t>(joint.parent)].name,
                               readable(length, 4), readable(box.sizes().maxCoeff(), 4)),
                   file_name, diagnostics);
  }
}

std::string readable_name(std::string_view name) {
  return name.empty() ? "a joint without a name" : shown(name);
}

}  // namespace krok::bvh
