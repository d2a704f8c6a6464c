#include "formats/goals/goals.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "motion/ground_frame.h"
#include "scene/frame_moment.h"

namespace krok::goals {

namespace {

using ik::Goal;
using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.goals/1";
constexpr std::string_view kWhole = "the file";
constexpr std::size_t kMaxGoals = 1000;
constexpr std::size_t kMaxKeys = 100'000;
constexpr double kFurthest = 1e6;  // metres
constexpr double kLatest = 1e6;    // seconds

class Reader {
 public:
  Reader(std::string_view text, const Skeleton& skeleton, const RoleMap& roles)
      : text_(text), in_(text, "goals"), skeleton_(skeleton), roles_(roles) {}

  Result<GoalFile> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(
            *root, kWhole,
            {"schema", "comment", "length_unit", "rate", "root_moves", "stiffness", "goals"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    for (const auto part : {&Reader::read_units, &Reader::read_stiffness, &Reader::read_goals}) {
      if (Status status = (this->*part)(*root); !status) return status.error();
    }
    return std::move(file_);
  }

 private:
  Status read_units(const Value& root) {
    const auto unit = in_.choice(root, kWhole, "length_unit", {"m", "cm", "mm", "in", "ft"});
    if (!unit) return unit.error();
    static constexpr std::array kMetres = {1.0, 0.01, 0.001, 0.0254, 0.3048};
    if (*unit) metres_ = kMetres[**unit];
    if (root.find("rate") != nullptr) {
      const auto rate = in_.number(root, kWhole, "rate", kMinRate, kMaxRate);
      if (!rate) return rate.error();
      rate_ = *rate;
    }
    const auto moves = in_.find(root, kWhole, "root_moves", Kind::boolean);
    if (!moves) return moves.error();
    file_.root_moves = *moves != nullptr && (*moves)->truth;
    return {};
  }

  Status read_stiffness(const Value& root) {
    const auto list = in_.find(root, kWhole, "stiffness", Kind::object);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    file_.stiffness.assign(skeleton_.names.size(), 0.0);
    for (const Value::Member& member : (*list)->members) {
      const auto joint = joint_named(member.key, member.key_offset);
      if (!joint) return joint.error();
      const auto value =
          in_.within(member.value, fmt::format("the stiffness of '{}'", shown(member.key)), 0, 1);
      if (!value) return value.error();
      file_.stiffness[at(*joint)] = *value;
    }
    return {};
  }

  Result<int> joint_named(const std::string& name, std::size_t offset) const {
    const int joint = find_joint(name, skeleton_, roles_);
    if (joint >= 0) return joint;
    return json::error_at(
        text_, offset, "goals-joint",
        fmt::format("the motion has no joint '{}', nor one of that role", shown(name)),
        nearest_hint(name, skeleton_.names));
  }

  // An optional joint: -1 if the member is missing.
  Result<int> joint(const Value& item, std::string_view what, std::string_view key,
                    bool needed) const {
    const auto value =
        needed ? in_.get(item, what, key, Kind::string) : in_.find(item, what, key, Kind::string);
    if (!value) return value.error();
    if (*value == nullptr) return -1;
    return joint_named((*value)->text, (*value)->offset);
  }

  // Reads `count` finite numbers; leaves `to` alone and gives false if the member is missing.
  Result<bool> numbers(const Value& item, std::string_view what, std::string_view key,
                       std::size_t count, double* to) const {
    const auto list = in_.find(item, what, key, Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return false;
    const auto& items = (*list)->items;
    bool good = items.size() == count;
    for (std::size_t i = 0; good && i < count; ++i) {
      good = items[i].kind == Kind::number && std::abs(items[i].number) <= 1e9;
      if (good) to[i] = items[i].number;
    }
    if (good) return true;
    return in_.wrong(**list, fmt::format("\"{}\" of {} must be {} numbers", key, what, count));
  }

  Result<bool> place(const Value& item, std::string_view what, std::string_view key,
                     Vec3& to) const {
    auto given = numbers(item, what, key, 3, to.data());
    if (!given || !*given) return given;
    to *= metres_;
    if (to.cwiseAbs().maxCoeff() <= kFurthest) return true;
    return in_.wrong(*item.find(key),
                     fmt::format("\"{}\" of {} is farther away than 1000 km", key, what));
  }

  Status read_direction(const Value& item, std::string_view what, Goal& goal) const {
    goal.axis = facing_axis(goal.joint, skeleton_);
    const auto given = numbers(item, what, "axis", 3, goal.axis.data());
    if (!given) return given.error();
    if (!*given) return {};
    const double length = goal.axis.norm();
    if (!(length > 1e-6)) {
      return in_.wrong(*item.find("axis"), fmt::format("\"axis\" of {} has no length", what));
    }
    goal.axis /= length;
    return {};
  }

  Status read_key(const Value& item, const std::string& what, Goal::Kind kind,
                  ik::GoalKey& key) const {
    const bool turns = kind == Goal::Kind::orientation || kind == Goal::Kind::pose;
    const auto target = place(item, what, "target", key.target);
    if (!target) return target.error();
    if (!*target && kind != Goal::Kind::orientation) {
      return in_.structure(item, fmt::format("{} is missing \"target\"", what));
    }
    double q[4] = {0, 0, 0, 1};
    const auto orientation = numbers(item, what, "orientation", 4, q);
    if (!orientation) return orientation.error();
    if (*orientation != turns) {
      return in_.structure(item, turns ? fmt::format("{} is missing \"orientation\"", what)
                                       : fmt::format("{} has an \"orientation\", which a goal of "
                                                     "its kind does not use",
                                                     what));
    }
    const Quat given(q[3], q[0], q[1], q[2]);
    if (!(std::abs(given.norm() - 1) < 0.01)) {
      return in_.wrong(*item.find("orientation"),
                       fmt::format("\"orientation\" of {} has length {}, expected 1", what,
                                   readable(given.norm())),
                       "it is a unit quaternion: x, y, z, w");
    }
    key.orientation = given.normalized();
    return read_easing(item, what, "easing", key.easing);
  }

  Status read_easing(const Value& item, std::string_view what, std::string_view key,
                     timeline::Easing& easing) const {
    const auto value = in_.find(item, what, key, Kind::string);
    if (!value) return value.error();
    if (*value == nullptr) return {};
    const auto parsed = timeline::parse_easing((*value)->text);
    if (!parsed) {
      return in_.wrong(**value,
                       fmt::format("\"{}\" of {} is '{}'", key, what, shown((*value)->text)),
                       nearest_hint((*value)->text, timeline::easing_names()));
    }
    easing = *parsed;
    return {};
  }

  Status read_keys(const Value& item, const std::string& what, ik::KeyedGoal& goal) const {
    const auto list = in_.find(item, what, "keys", Kind::array);
    if (!list) return list.error();
    if (*list == nullptr || (*list)->items.empty()) {
      if (goal.goal.kind == Goal::Kind::balance && *list == nullptr) return {};
      return in_.structure(item, fmt::format("{} has no \"keys\"", what));
    }
    if (goal.goal.kind == Goal::Kind::balance || (*list)->items.size() > kMaxKeys) {
      return in_.wrong(**list, fmt::format("{} cannot have {} keys", what, (*list)->items.size()));
    }
    for (std::size_t i = 0; i < (*list)->items.size(); ++i) {
      const Value& given = (*list)->items[i];
      const std::string which = fmt::format("key {} of {}", i, what);
      if (Status status =
              in_.only(given, which, {"time", "target", "orientation", "easing", "comment"});
          !status) {
        return status;
      }
      ik::GoalKey key;
      const auto time = in_.moment(given, which, "time", rate_, kLatest);
      if (!time) return time.error();
      key.time = *time;
      if (i > 0 && !(key.time > goal.keys.back().time)) {
        return json::error_at(
            text_, given.find("time")->offset, "goals-time",
            fmt::format("{} is at {} s, not after the one before it at {} s", which,
                        readable(key.time, 9), readable(goal.keys.back().time, 9)));
      }
      if (Status status = read_key(given, which, goal.goal.kind, key); !status) return status;
      goal.keys.push_back(key);
    }
    return {};
  }

  Status read_times(const Value& item, const std::string& what, ik::KeyedGoal& goal) const {
    const auto moment = [&](const char* key, auto& to) -> Status {
      if (item.find(key) == nullptr) return {};
      const auto time = in_.moment(item, what, key, rate_, kLatest);
      if (!time) return time.error();
      to = *time;
      return {};
    };
    if (Status status = moment("from", goal.from); !status) return status;
    if (Status status = moment("to", goal.to); !status) return status;
    if (Status status = moment("fade_in", goal.fade_in); !status) return status;
    if (Status status = moment("fade_out", goal.fade_out); !status) return status;
    if (goal.from && goal.to && *goal.from > *goal.to) {
      return json::error_at(text_, item.find("to")->offset, "goals-time",
                            fmt::format("{} ends before it begins", what));
    }
    return read_easing(item, what, "fade", goal.fade);
  }

  Status read_space(const Value& item, const std::string& what, ik::KeyedGoal& goal) {
    const auto motion = in_.find(item, what, "motion", Kind::string);
    if (!motion) return motion.error();
    if (*motion == nullptr) {
      const auto joint_of = joint(item, what, "relative_to", false);
      if (!joint_of) return joint_of.error();
      goal.relative_to = *joint_of;
      return {};
    }
    const auto name = in_.get(item, what, "relative_to", Kind::string);
    if (!name) return name.error();
    const auto path = in_.path(**motion, fmt::format("\"motion\" of {}", what));
    if (!path) return path.error();
    file_.others.push_back({file_.goals.size(), *path, (*name)->text,
                            locate(text_, (*motion)->offset, std::string())});
    return {};
  }

  Status read_support(const Value& item, const std::string& what, ik::KeyedGoal& goal) const {
    const auto list = in_.find(item, what, "support", Kind::array);
    if (!list) return list.error();
    if ((*list != nullptr) != (goal.goal.kind == Goal::Kind::balance)) {
      if (*list != nullptr)
        return in_.wrong(**list, fmt::format("{} has a \"support\"", what),
                         "only a goal of the kind balance has one");
      goal.support_joints = foot_joints(skeleton_, roles_);
      return {};
    }
    if (*list == nullptr) return {};
    for (const Value& name : (*list)->items) {
      if (name.kind != Kind::string) {
        return in_.wrong(name, fmt::format("\"support\" of {} is a list of joints", what));
      }
      const auto found = joint_named(name.text, name.offset);
      if (!found) return found.error();
      goal.support_joints.push_back(*found);
    }
    if (!goal.support_joints.empty()) return {};
    return in_.wrong(**list, fmt::format("\"support\" of {} is empty", what));
  }

  Status read_numbers(const Value& item, const std::string& what, Goal& goal) const {
    if (item.find("weight") != nullptr) {
      const auto weight = in_.number(item, what, "weight", 1e-3, 1e3);
      if (!weight) return weight.error();
      goal.weight = *weight;
    }
    if (item.find("depth") == nullptr) {
      if (goal.kind != Goal::Kind::balance) {
        goal.depth = default_depth(goal.joint, skeleton_, roles_);
      }
      return {};
    }
    const auto depth = in_.number(item, what, "depth", 0, 1e4);
    if (!depth) return depth.error();
    if (*depth != std::floor(*depth)) {
      return in_.wrong(*item.find("depth"), fmt::format("\"depth\" of {} is not whole", what));
    }
    goal.depth = static_cast<int>(*depth);
    return {};
  }

  Status read_limb(const Value& item, const std::string& what, Goal& goal) const {
    const auto upper = joint(item, what, "upper", false);
    if (!upper) return upper.error();
    const auto lower = joint(item, what, "lower", false);
    if (!lower) return lower.error();
    goal.upper = *upper;
    goal.lower = *lower;
    if (const auto given = place(item, what, "point", goal.point); !given) return given.error();
    return read_direction(item, what, goal);
  }

  Status read_goal(const Value& item, std::size_t index) {
    const std::string what = fmt::format("goal {}", index);
    if (Status status = in_.only(item, what,
                                 {"name", "kind", "joint", "point", "axis", "upper", "lower",
                                  "relative_to", "motion", "keys", "from", "to", "fade_in",
                                  "fade_out", "fade", "weight", "depth", "support", "comment"});
        !status) {
      return status;
    }
    ik::KeyedGoal goal;
    const auto kind = in_.choice(item, what, "kind",
                                 {"position", "orientation", "pose", "look-at", "pole", "balance"});
    if (!kind) return kind.error();
    goal.goal.kind = static_cast<Goal::Kind>(kind->value_or(0));
    const bool balance = goal.goal.kind == Goal::Kind::balance;
    const auto found = joint(item, what, "joint", !balance);
    if (!found) return found.error();
    goal.goal.joint = std::max(0, *found);
    const auto name = in_.find(item, what, "name", Kind::string);
    if (!name) return name.error();
    goal.name = *name != nullptr ? (*name)->text
                : balance        ? std::string("balance")
                                 : skeleton_.names[at(goal.goal.joint)];
    if (Status status = read_limb(item, what, goal.goal); !status) return status;
    if (Status status = read_numbers(item, what, goal.goal); !status) return status;
    if (Status status = read_space(item, what, goal); !status) return status;
    if (Status status = read_keys(item, what, goal); !status) return status;
    if (Status status = read_times(item, what, goal); !status) return status;
    if (Status status = read_support(item, what, goal); !status) return status;
    file_.goals.push_back(std::move(goal));
    return {};
  }

  Status read_goals(const Value& root) {
    const auto list = in_.get(root, kWhole, "goals", Kind::array);
    if (!list) return list.error();
    const std::size_t count = (*list)->items.size();
    if (count == 0 || count > kMaxGoals) {
      return in_.wrong(**list, fmt::format("{} goals, expected 1 to {}", count, kMaxGoals));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (Status status = read_goal((*list)->items[i], i); !status) return status;
    }
    return {};
  }

  std::string_view text_;
  json::Members in_;
  const Skeleton& skeleton_;
  const RoleMap& roles_;
  GoalFile file_;
  std::optional<double> rate_;
  double metres_ = 1;
};

}  // namespace

int find_joint(std::string_view name, const Skeleton& skeleton, const RoleMap& roles) {
  const int joint = skeleton.find(name);
  if (joint >= 0) return joint;
  const auto role = parse_role(name);
  return role ? roles.joint(*role) : -1;
}

int default_depth(int joint, const Skeleton& skeleton, const RoleMap& roles) {
  const int carrier = carrying_joint(roles);
  int depth = 0;
  for (int j = joint; j >= 0; j = skeleton.parents[at(j)]) {
    if (j == carrier) return depth;
    ++depth;
  }
  return 0;
}

Vec3 facing_axis(int joint, const Skeleton& skeleton) {
  return skeleton.reference[at(joint)].orientation.normalized().conjugate() * Vec3::UnitZ();
}

Result<GoalFile> read(std::string_view text, const Skeleton& skeleton, const RoleMap& roles) {
  return Reader(text, skeleton, roles).read();
}

}  // namespace krok::goals
