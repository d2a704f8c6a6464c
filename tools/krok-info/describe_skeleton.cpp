#include "tools/krok-info/describe_skeleton.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/numbers.h"
#include "tools/shared/role_report.h"

namespace krok::cli::info {

namespace {

std::vector<int> depths_of(const Skeleton& skeleton) {
  std::vector<int> depths;
  for (const int parent : skeleton.parents) {
    depths.push_back(parent < 0 ? 0 : depths[at(parent)] + 1);
  }
  return depths;
}

}  // namespace

void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, double metres,
                  Description& out) {
  const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
  std::string joints = grouped(skeleton.joint_count());
  if (ends > 0) joints += fmt::format(", {} of them end sites", ends);
  out.add("joints", joints);
  for (RoleRow& row : role_rows(skeleton, map)) out.add(std::move(row.label), std::move(row.text));

  auto stature = stature_of(skeleton, map);
  if (stature) {
    stature->metres *= metres;
    stature->uncertainty *= metres;
    out.add("stature",
            fmt::format("{} m, within {} m, by the lengths of legs, spine and arms",
                        readable(stature->metres, 3), readable(stature->uncertainty, 2)));
  }
  out.json["stature"] = stature_json(stature);
  out.json["joints"] = skeleton.joint_count();
  out.json["end_sites"] = ends;
  out.json.update(roles_json(skeleton, map));
  out.json["skeleton"] = Json::array();
  std::vector<std::string> lines;
  const std::vector<int> depths = depths_of(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string label = role_label(map, j);
    lines.push_back(fmt::format("{:<23} {:>{}}{}", label == "none" ? "-" : label, "",
                                2 * std::min(depths[at(j)], 40), skeleton.names[at(j)]));
    const int parent = skeleton.parents[at(j)];
    const Vec3 place = metres * skeleton.reference[at(j)].position;
    const Quat& turn = skeleton.reference[at(j)].orientation;
    out.json["skeleton"].push_back(
        {{"joint", skeleton.names[at(j)]},
         {"parent", parent < 0 ? Json() : Json(skeleton.names[at(parent)])},
         {"role", label == "none" ? Json() : Json(label)},
         {"position", {place.x(), place.y(), place.z()}},
         {"orientation", {turn.x(), turn.y(), turn.z(), turn.w()}}});
  }
  if (verbose) out.add("roles", std::move(lines));
}

Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out) {
  const auto map = options.roles(skeleton);
  if (!map) return map.error();
  add_skeleton(skeleton, *map, options.verbose, 1, out);
  return {};
}

}  // namespace krok::cli::info
