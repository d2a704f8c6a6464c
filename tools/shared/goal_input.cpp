#include "tools/shared/goal_input.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/text.h"
#include "formats/goals/goals.h"
#include "formats/io/open_motion.h"
#include "tools/cli/paths.h"

namespace krok::cli {

namespace {

Status open_other(const std::string& goal_path, const goals::OtherMotion& other,
                  ToolContext& context, OpenedGoals& opened) {
  const std::string folder = std::filesystem::path(goal_path).parent_path().string();
  auto clip = io::open_motion(below(folder, other.path), context);
  if (!clip) return clip.error();
  const auto roles = find_roles(clip->skeleton);
  const int joint = find_joint(clip->skeleton, roles, other.joint);
  if (joint < 0) {
    Error error("goals-joint",
                fmt::format("'{}' has no joint '{}', nor one of that role", shown(other.path),
                            shown(other.joint)),
                nearest_hint(other.joint, clip->skeleton.names));
    error.where = other.where;
    return std::move(error).in_file(goal_path);
  }
  opened.motions.push_back(std::move(*clip));
  opened.goals[other.goal].motion = &opened.motions.back();
  opened.goals[other.goal].relative_to = joint;
  return {};
}

}  // namespace

Result<OpenedGoals> open_goals(const std::string& path, const Skeleton& skeleton,
                               const RoleMap& roles, ToolContext& context,
                               std::span<const Character::Socket> sockets) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto read = goals::read(file->text(), skeleton, roles, sockets);
  if (!read) return std::move(read).error().in_file(path);
  OpenedGoals opened;
  opened.goals = std::move(read->goals);
  opened.stiffness = std::move(read->stiffness);
  opened.root_moves = read->root_moves;
  for (const goals::OtherMotion& other : read->others) {
    if (Status status = open_other(path, other, context, opened); !status) return status.error();
  }
  return opened;
}

}  // namespace krok::cli
