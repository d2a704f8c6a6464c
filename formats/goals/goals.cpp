#include "formats/goals/goals.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"

namespace krok::goals {

namespace {

using ik::Goal;
using ik::GoalKey;
using ik::KeyedGoal;
using json::Given;
using timeline::Easing;
using JsonKind = json::Value::Kind;

constexpr std::size_t kMaxKeys = 100'000;
constexpr double kMaxNumber = 1e9;
constexpr double kLatest = 1e6;  // seconds

json::Kind<Easing> easing() {
  return json::kind<Easing>(R"({"type": "string"})", [](const Given& given, Easing& to) -> Status {
    if (Status status = given.is(JsonKind::string); !status) return status;
    const auto parsed = timeline::parse_easing(given.value.text);
    if (!parsed) {
      return given.wrong(fmt::format("{} is '{}'", given.name(), shown(given.value.text)),
                         nearest_hint(given.value.text, timeline::easing_names()));
    }
    to = *parsed;
    return {};
  });
}

struct File {
  const Skeleton& skeleton;
  const RoleMap& roles;
  std::optional<double> rate = {};
  double metres = 1;
  Goal::Kind kind = Goal::Kind::position;  // of the goal that is read
  std::vector<OtherMotion> others = {};
  std::span<const Character::Socket> sockets = {};

  Result<int> joint_named(const Given& given, std::string_view name) const {
    const int joint = find_joint(skeleton, roles, name);
    if (joint >= 0) return joint;
    return given.error(
        "joint", fmt::format("the motion has no joint '{}', nor one of that role", shown(name)),
        nearest_hint(name, skeleton.names));
  }

  json::Kind<int> joint() const {
    return json::kind<int>(R"({"description": "a joint, by name or role", "type": "string"})",
                           [this](const Given& given, int& to) -> Status {
                             Status status = given.is(JsonKind::string);
                             if (!status) return status;
                             const auto found = joint_named(given, given.value.text);
                             if (!found) return found.error();
                             to = *found;
                             return {};
                           });
  }

  json::Kind<Vec3> axis() const {
    return json::kind<Vec3>(json::schema_of_numbers(3), [](const Given& given, Vec3& to) -> Status {
      if (Status status = json::vector(kMaxNumber).read(given, &to); !status) return status;
      const double length = to.norm();
      if (!(length > 1e-6)) return given.wrong(fmt::format("{} has no length", given.name()));
      to /= length;
      return {};
    });
  }

  json::Object<GoalKey> key_table() const {
    json::Object<GoalKey> key;
    key.field("time", &GoalKey::time, json::moment(rate, kLatest)).required();
    key.field("target", &GoalKey::target, json::place(metres, kMaxNumber));
    key.check([this](const Given& given, GoalKey&) -> Status {
      const bool turns = kind == Goal::Kind::orientation || kind == Goal::Kind::pose;
      if (!given.has("target") && kind != Goal::Kind::orientation) {
        return given.structure(fmt::format("{} is missing \"target\"", given.what));
      }
      if (turns == given.has("orientation")) return {};
      if (turns) return given.structure(fmt::format("{} is missing \"orientation\"", given.what));
      return given.structure(fmt::format(
          "{} has an \"orientation\", which a goal of its kind does not use", given.what));
    });
    key.field("orientation", &GoalKey::orientation, json::rotation(0.01, 0), "x, y, z, w");
    return key.field("easing", &GoalKey::easing, easing(), "to the next key").comment();
  }

  Status check_keys(const Given& goal) const {
    const bool balance = kind == Goal::Kind::balance;
    const json::Value* const keys = goal.value.find("keys");
    if (keys == nullptr && balance) return {};
    if (keys == nullptr || (keys->kind == JsonKind::array && keys->items.empty())) {
      return goal.structure(fmt::format("{} has no \"keys\"", goal.what));
    }
    if (keys->kind != JsonKind::array || (!balance && keys->items.size() <= kMaxKeys)) return {};
    return goal.member("keys").wrong(
        fmt::format("{} cannot have {} keys", goal.what, keys->items.size()));
  }

  static Status check_order(const Given& key, const std::vector<GoalKey>& keys) {
    if (keys.size() < 2) return {};
    const double before = keys[keys.size() - 2].time, time = keys.back().time;
    if (time > before) return {};
    return key.member("time").error(
        "time", fmt::format("{} is at {} s, not after the one before it at {} s", key.what,
                            readable(time, 9), readable(before, 9)));
  }

  // What a goal has unless the file says otherwise.
  Status set_defaults(const Given& goal, KeyedGoal& to) {
    kind = to.goal.kind;
    if (!goal.has("joint") && kind != Goal::Kind::balance) {
      return goal.structure(fmt::format("{} is missing \"joint\"", goal.what));
    }
    if (to.name.empty()) {
      to.name = kind == Goal::Kind::balance ? "balance" : skeleton.names[at(to.goal.joint)];
    }
    to.goal.axis = facing_axis(to.goal.joint, skeleton, roles);
    if (kind == Goal::Kind::balance) {
      if (!goal.has("support")) to.support_joints = foot_joints(skeleton, roles);
    } else {
      to.goal.depth = default_depth(to.goal.joint, skeleton, roles);
    }
    return {};
  }

  // "relative_to" is a joint of the same motion, or of "motion".
  Status read_space(const Given& goal, KeyedGoal& to) {
    if (!goal.has("motion")) {
      return goal.has("relative_to") ? joint().read(goal.member("relative_to"), &to.relative_to)
                                     : Status();
    }
    if (!goal.has("relative_to")) {
      return goal.structure(fmt::format("{} is missing \"relative_to\"", goal.what));
    }
    OtherMotion other{
        goals_read, {}, goal.member("relative_to").value.text, goal.member("motion").where()};
    Status status = json::path().read(goal.member("motion"), &other.path);
    others.push_back(std::move(other));
    return status;
  }

  json::Object<KeyedGoal> goal_table() {
    json::Object<KeyedGoal> goal;
    const auto in_goal = [](auto member) {
      return [member](KeyedGoal & of) -> auto& {
        return of.goal.*member;
      };
    };
    const auto text = [] {
      return json::kind<KeyedGoal>(R"({"type": "string"})", [](const Given& given, KeyedGoal&) {
        return given.is(JsonKind::string);
      });
    };
    const auto time = json::moment(rate, kLatest);
    goal.field("name", &KeyedGoal::name, json::text(), "for reports");
    goal.field("kind", in_goal(&Goal::kind),
               json::choice<Goal::Kind>({{"position", Goal::Kind::position},
                                         {"orientation", Goal::Kind::orientation},
                                         {"pose", Goal::Kind::pose},
                                         {"look-at", Goal::Kind::look_at},
                                         {"pole", Goal::Kind::pole},
                                         {"balance", Goal::Kind::balance}}));
    json::Kind<int> joint_or_socket = joint();
    joint_or_socket.read = [this, read = joint_or_socket.read](const Given& given, void* to) {
      const auto socket = std::ranges::find(sockets, given.value.text, &Character::Socket::name);
      const int found = socket == sockets.end() ? -1 : skeleton.find(socket->joint);
      if (found < 0) return read(given, to);
      *static_cast<int*>(to) = found;
      return Status();
    };
    goal.field("joint", in_goal(&Goal::joint), joint_or_socket);
    goal.check([this](const Given& given, KeyedGoal& to) -> Status {
      if (!given.has("joint")) return {};
      const auto socket =
          std::ranges::find(sockets, given.member("joint").value.text, &Character::Socket::name);
      if (socket == sockets.end()) return {};
      to.goal.point = socket->offset.cast<double>();
      if (!given.has("name")) to.name = socket->name;
      return {};
    });
    goal.check([this](const Given& given, KeyedGoal& to) { return set_defaults(given, to); });
    goal.field("point", in_goal(&Goal::point), json::place(metres, kMaxNumber));
    goal.field("axis", in_goal(&Goal::axis), axis());
    goal.field("upper", in_goal(&Goal::upper), joint());
    goal.field("lower", in_goal(&Goal::lower), joint());
    goal.field("relative_to", text());
    goal.field("motion", text(), "path relative to this file");
    goal.check([this](const Given& given, KeyedGoal& to) { return read_space(given, to); });
    goal.check([this](const Given& given, KeyedGoal&) { return check_keys(given); });
    goal.field("keys", &KeyedGoal::keys,
               json::list<GoalKey>(json::object(key_table()), {"key {0} of {1}", 1, kMaxKeys},
                                   check_order));
    goal.field("from", &KeyedGoal::from, time);
    goal.field("to", &KeyedGoal::to, time);
    goal.field("fade_in", &KeyedGoal::fade_in, time);
    goal.field("fade_out", &KeyedGoal::fade_out, time);
    goal.check([](const Given& given, KeyedGoal& to) -> Status {
      if (!to.from || !to.to || *to.from <= *to.to) return {};
      return given.member("to").error("time", fmt::format("{} ends before it begins", given.what));
    });
    goal.field("fade", &KeyedGoal::fade, easing());
    goal.field("weight", in_goal(&Goal::weight), json::number(1e-3, 1e3));
    goal.field("depth", in_goal(&Goal::depth), depth(), "count of joints; 0: all");
    goal.check([](const Given& given, KeyedGoal& to) -> Status {
      if (!given.has("support") || to.goal.kind == Goal::Kind::balance) return {};
      Status array = given.member("support").is(JsonKind::array);
      if (!array) return array;
      return given.member("support").wrong(fmt::format("{} has a \"support\"", given.what),
                                           "only a goal of the kind balance has one");
    });
    goal.field("support", &KeyedGoal::support_joints,
               json::list<int>(support_joint(), {"{1}", 1, SIZE_MAX, "{4} is empty"}));
    goal.comment();
    goal.check([this](const Given&, KeyedGoal&) { return ++goals_read, Status(); });
    return goal;
  }

  json::Kind<int> support_joint() const {
    json::Kind<int> kind_of = joint();
    kind_of.read = [read = kind_of.read](const Given& given, void* to) -> Status {
      if (given.value.kind == JsonKind::string) return read(given, to);
      return given.wrong(fmt::format("\"support\" of {} is a list of joints", given.what));
    };
    return kind_of;
  }

  static json::Kind<int> depth() {
    return json::kind<int>(R"({"type": "integer", "minimum": 0, "maximum": 10000})",
                           [](const Given& given, int& to) -> Status {
                             double value = 0;
                             Status status = json::number(0, 1e4).read(given, &value);
                             to = static_cast<int>(value);
                             if (!status || to == value) return status;
                             return given.wrong(fmt::format("{} is not whole", given.name()));
                           });
  }

  json::Object<GoalFile> table() {
    json::Object<GoalFile> file;
    file.file("krok.goals/1", "Goals of inverse kinematics (krok.goals/1)").comment();
    file.context("length_unit", metres,
                 json::choice<double>(
                     {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}));
    file.context("rate", rate, json::frame_rate(), "frames per second");
    file.field("root_moves", &GoalFile::root_moves, json::boolean());
    file.field("stiffness", &GoalFile::stiffness,
               json::keyed<std::vector<double>>(
                   json::number(0, 1), "the stiffness of '{0}'",
                   [this](const Given& key, std::vector<double>& to) -> Result<double*> {
                     const auto joint = joint_named(key, key.key);
                     if (!joint) return joint.error();
                     to.resize(skeleton.names.size());
                     return &to[at(*joint)];
                   }));
    file.field("goals", &GoalFile::goals,
               json::list<KeyedGoal>(json::object(goal_table()), {"goal {0}", 1, 1000}))
        .required();
    return file;
  }

  std::size_t goals_read = 0;
};

}  // namespace

int default_depth(int joint, const Skeleton& skeleton, const RoleMap& roles) {
  const int carrier = carrying_joint(roles);
  const auto carries_a_leg = [&](int above) {
    const std::vector<std::uint8_t> within = subtree(skeleton, above);
    return std::ranges::any_of(std::array{Role::left_upper_leg, Role::right_upper_leg},
                               [&](Role role) {
                                 const int leg = roles.joint(role);
                                 return leg >= 0 && leg != above && within[at(leg)] != 0;
                               });
  };
  int depth = 0;
  for (int j = joint; j >= 0; j = skeleton.parents[at(j)]) {
    if (j == carrier) return depth;
    // In some rigs (Biped) the lowest of the spine.
    if (depth > 0 && carries_a_leg(j)) return depth;
    ++depth;
  }
  return 0;
}

Vec3 facing_axis(int joint, const Skeleton& skeleton, const RoleMap& roles) {
  return skeleton.reference[at(joint)].orientation.normalized().conjugate() *
         (body_frame(skeleton, roles) * Vec3::UnitZ());
}

Result<GoalFile> read(std::string_view text, const Skeleton& skeleton, const RoleMap& roles,
                      std::span<const Character::Socket> sockets) {
  File file{skeleton, roles};
  file.sockets = sockets;
  auto goals = file.table().read_text(text, "goals");
  if (goals) goals->others = std::move(file.others);
  return goals;
}

std::string schema() {
  return File{{}, {}}.table().schema();
}

}  // namespace krok::goals
