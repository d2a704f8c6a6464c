#include "formats/bvh/finish_hierarchy_internal.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "formats/bvh/names.h"

namespace krok::bvh {

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
  std::vector<JointName> places;
  places.reserve(hierarchy.joints.size());
  for (std::size_t i = 0; i < hierarchy.joints.size(); ++i) {
    auto& joint = hierarchy.joints[i];
    places.push_back({&joint.name, joint.parent, joint.end_site, name_places[i]});
  }
  make_names_unique(places, text, file_name, diagnostics);
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

}  // namespace krok::bvh
