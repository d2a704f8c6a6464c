#include "tools/shared/retarget_outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/index.h"
#include "core/numbers.h"
#include "retarget/stance.h"
#include "roles/body_frame.h"

namespace krok::cli {

namespace {

// Radians; feet of T-poses point up to 30 degrees outwards.
constexpr double kTurnedFoot = 40 * kRadiansPerDegree;
constexpr double kShownBend = 10 * kRadiansPerDegree;  // of a knee

std::string method_name(krok::retarget::Method method) {
  constexpr std::array kNames = {"same skeleton", "roles", "names"};  // [Method]
  return kNames[static_cast<std::size_t>(method)];
}

std::string label_of(const RoleMap& roles, int joint) {
  const std::string label = role_label(roles, joint);
  return label == "none" ? "-" : label;
}

std::string names_of(const Skeleton& skeleton, const std::vector<int>& joints) {
  std::string text;
  for (const int joint : joints) {
    text += (text.empty() ? "" : ", ") + skeleton.names[at(joint)];
  }
  return text;
}

// Source joints that have a role but are not used; likely of interest to the user.
std::vector<int> with_a_role(const std::vector<int>& joints, const RoleMap& roles) {
  std::vector<int> found;
  for (const int joint : joints) {
    const Role role = roles.roles[at(joint)];
    if (role != Role::none && role != Role::helper && role != Role::root) found.push_back(joint);
  }
  return found;
}

std::string source_text(const Outcome& outcome, const krok::retarget::MappedJoint& joint) {
  const std::string& first = outcome.source.names[at(joint.source)];
  if (joint.second_source < 0) return first;
  return fmt::format("{} + {} ({} %)", first, outcome.source.names[at(joint.second_source)],
                     readable(100 * joint.share, 2));
}

Json foot_json(const std::optional<krok::retarget::FootReport>& foot) {
  if (!foot) return {};
  const auto frame = [](int number) { return number < 0 ? Json() : Json(number); };
  return {{"largest_correction", foot->largest_correction},
          {"largest_correction_frame", frame(foot->largest_correction_frame)},
          {"largest_miss", foot->largest_miss},
          {"largest_miss_frame", frame(foot->largest_miss_frame)},
          {"largest_knee_change", foot->largest_bend},
          {"largest_knee_change_frame", frame(foot->largest_bend_frame)},
          {"largest_depth", foot->largest_depth},
          {"largest_depth_time", foot->largest_depth_time}};
}

// The largest of every measure over all contacts.
std::string contacts_text(const std::vector<krok::retarget::ContactReport>& contacts,
                          double scale) {
  if (contacts.empty()) return {};
  double slide = 0, height = 0, apart = 0;
  for (const krok::retarget::ContactReport& contact : contacts) {
    slide = std::max(slide, contact.slide - scale * contact.source_slide);
    height = std::max(height, contact.height);
    apart = std::max(apart, contact.apart);
  }
  return fmt::format(
      ", {} contacts: slide at most {}/s more than the input's, scaled, heights within {}, "
      "distances of "
      "hands within {}",
      contacts.size(), millimetres(slide), millimetres(height), millimetres(apart));
}

Json contact_json(const krok::retarget::ContactReport& contact) {
  Json json = {
      {"part", contact.part}, {"on", contact.on}, {"start", contact.start}, {"end", contact.end}};
  if (contact.on == "ground") {
    json["slide"] = contact.slide;
    json["input_slide"] = contact.source_slide;
    json["height_off"] = contact.height;
  } else {
    json["distance_off"] = contact.apart;
  }
  return json;
}

}  // namespace

std::string summary(const Outcome& outcome) {
  const krok::retarget::Report& report = outcome.report;
  std::string text =
      fmt::format("{} of {} joints mapped by {}, scale {}", report.mapped.size(),
                  std::count(outcome.target.end_sites.begin(), outcome.target.end_sites.end(), 0),
                  method_name(report.method), readable(report.scale, 4));
  const auto& left = report.left_foot;
  const auto& right = report.right_foot;
  if (left || right) {
    const double left_max = left ? left->largest_correction : 0;
    const double right_max = right ? right->largest_correction : 0;
    text += fmt::format(", feet corrected by up to {}", millimetres(std::max(left_max, right_max)));
    const double miss = std::max(left ? left->largest_miss : 0, right ? right->largest_miss : 0);
    if (report.largest_drop > 0.001) {
      text += fmt::format(", hips lowered by up to {}", millimetres(report.largest_drop));
    }
    if (miss > 0.005) text += fmt::format(" (legs too short by {})", millimetres(miss));
    const double bend = std::max(left ? std::abs(left->largest_bend) : 0,
                                 right ? std::abs(right->largest_bend) : 0);
    if (bend > kShownBend) {
      text +=
          fmt::format(", knees bent by up to {:.0f} deg more or less", bend / kRadiansPerDegree);
    }
  }
  return text + contacts_text(report.contacts, report.path_scale);
}

std::string table(const Outcome& outcome) {
  const krok::retarget::Report& report = outcome.report;
  std::size_t role_width = 4, target_width = 6;
  for (const krok::retarget::MappedJoint& joint : report.mapped) {
    role_width = std::max(role_width, label_of(outcome.target_roles, joint.target).size());
    target_width = std::max(target_width, outcome.target.names[at(joint.target)].size());
  }
  std::string text =
      fmt::format("  {:<{}}  {:<{}}  from\n", "role", role_width, "target", target_width);
  for (const krok::retarget::MappedJoint& joint : report.mapped) {
    text += fmt::format("  {:<{}}  {:<{}}  {}", label_of(outcome.target_roles, joint.target),
                        role_width, outcome.target.names[at(joint.target)], target_width,
                        source_text(outcome, joint));
    if (joint.alignment > 0.5 * kRadiansPerDegree) {
      text += fmt::format(", reference pose rotated by {} deg",
                          readable(joint.alignment / kRadiansPerDegree, 2));
    }
    text += "\n";
  }
  if (!report.following_target.empty()) {
    text += fmt::format("  follow their parents: {}\n",
                        names_of(outcome.target, report.following_target));
  }
  for (const krok::retarget::ContactReport& contact : report.contacts) {
    text += fmt::format("  {:.2f} to {:.2f} s: {} on {}, ", contact.start, contact.end,
                        contact.part, contact.on);
    text += contact.on == "ground"
                ? fmt::format("slides {}/s (input {}/s), height off by {}\n",
                              millimetres(contact.slide), millimetres(contact.source_slide),
                              millimetres(contact.height))
                : fmt::format("distance off by {}\n", millimetres(contact.apart));
  }
  if (!report.unused_source.empty()) {
    text +=
        fmt::format("  unused input joints: {}\n", names_of(outcome.source, report.unused_source));
  }
  return text;
}

Json to_json(const Outcome& outcome) {
  const krok::retarget::Report& report = outcome.report;
  Json json;
  json["method"] = method_name(report.method);
  json["scale"] = report.scale;
  json["floor"] = report.floor;
  json["reference_frame"] = report.source_frame ? Json(*report.source_frame) : Json();
  json["target_reference_frame"] = report.target_frame ? Json(*report.target_frame) : Json();
  json["joints"] = Json::array();
  for (const krok::retarget::MappedJoint& joint : report.mapped) {
    Json entry;
    entry["joint"] = outcome.target.names[at(joint.target)];
    const std::string label = role_label(outcome.target_roles, joint.target);
    entry["role"] = label == "none" ? Json() : Json(label);
    entry["from"] = outcome.source.names[at(joint.source)];
    if (joint.second_source >= 0) {
      entry["and_from"] = outcome.source.names[at(joint.second_source)];
      entry["share"] = joint.share;
    }
    entry["reference_turned"] = to_degrees(joint.alignment);
    json["joints"].push_back(std::move(entry));
  }
  const auto names = [](const Skeleton& skeleton, const std::vector<int>& joints) {
    Json list = Json::array();
    for (const int joint : joints) list.push_back(skeleton.names[at(joint)]);
    return list;
  };
  json["following"] = names(outcome.target, report.following_target);
  json["not_used"] = names(outcome.source, report.unused_source);
  json["not_used_with_role"] =
      names(outcome.source, with_a_role(report.unused_source, outcome.source_roles));
  json["fingers_at_rest"] = {{"left", report.left_fingers_at_rest},
                             {"right", report.right_fingers_at_rest}};
  json["largest_drop_of_hips"] = report.largest_drop;
  json["largest_shift_of_hips"] = report.largest_shift;
  json["largest_turn_of_trunk"] = to_degrees(report.largest_turn);
  json["largest_depth_of_hands_and_head"] = report.largest_depth;
  json["contacts"] = Json::array();
  for (const auto& contact : report.contacts) json["contacts"].push_back(contact_json(contact));
  json["feet"] = {{"left", foot_json(report.left_foot)}, {"right", foot_json(report.right_foot)}};
  return json;
}

namespace {

// What makes limbs of a part too long or too short for a contact; empty if nothing that is measured
// does.
std::string why_missed(const Outcome& outcome, const std::string& part) {
  constexpr double kUnlike = 0.05;  // of a ratio of lengths
  const auto ratio = [&](std::span<const Role> chain) {
    const auto length = [&](const Skeleton& skeleton, const RoleMap& roles) {
      double sum = 0;
      for (std::size_t i = 1; i < chain.size(); ++i) {
        const int from = roles.joint(chain[i - 1]), to = roles.joint(chain[i]);
        if (from < 0 || to < 0) return 0.0;
        sum += (skeleton.reference[at(to)].position - skeleton.reference[at(from)].position).norm();
      }
      return sum;
    };
    const double source = length(outcome.source, outcome.source_roles);
    const double target = length(outcome.target, outcome.target_roles);
    return source > 0 && target > 0 ? target / source : 0;
  };
  const bool is_left = !part.starts_with("right");
  const ArmRoles& arm = kArmRoles[is_left ? 0 : 1];
  const LegRoles& leg = kLegRoles[is_left ? 0 : 1];
  const double legs = ratio(std::array{leg.upper, leg.lower, leg.foot});
  if (legs == 0) return {};
  const double scale = outcome.report.scale;
  if (std::abs(scale / legs - 1) > kUnlike) {
    return fmt::format("lengths are scaled by {}, legs are {} of the input's; ", readable(scale, 3),
                       readable(legs, 3));
  }
  struct Bone {
    const char* name;
    double ratio;
  };
  std::vector<Bone> bones;
  if (part.ends_with("hand") || part.ends_with("elbow")) {
    bones = {{"upper arm", ratio(std::array{arm.upper, arm.lower})},
             {"forearm", ratio(std::array{arm.lower, arm.hand})},
             {"trunk", ratio(std::array{Role::hips, Role::neck})}};
  } else {
    bones = {{"thigh", ratio(std::array{leg.upper, leg.lower})},
             {"shank", ratio(std::array{leg.lower, leg.foot})},
             {"foot", ratio(std::array{leg.foot, leg.toes})}};
  }
  const auto unlike = [&](const Bone& bone) {
    return bone.ratio == 0 ? 0 : std::abs(std::log(bone.ratio / legs));
  };
  const Bone& most = *std::ranges::max_element(bones, {}, unlike);
  if (unlike(most) < kUnlike) return {};
  return fmt::format(
      "other proportions: for its legs the target's {} is {:.0f} % {} than the "
      "input's; ",
      most.name, 100 * std::abs(most.ratio / legs - 1), most.ratio > legs ? "longer" : "shorter");
}

// Contacts of the input that the result misses, as where an arm is too short for them. Distances
// count by the target's size.
std::optional<Diagnostic> missed_contacts(const Outcome& outcome) {
  constexpr double kUsualStature = 1.75;  // metres
  const krok::retarget::Report& report = outcome.report;
  const auto stature = stature_of(outcome.target, outcome.target_roles);
  const double size = stature ? stature->metres / kUsualStature : 1;
  constexpr double kHigh = 0.05, kFast = 0.2, kLong = 0.05;  // metres, metres per second, seconds
  int missed = 0;
  double most = 0;  // times the limit
  const krok::retarget::ContactReport* worst = nullptr;
  for (const krok::retarget::ContactReport& contact : report.contacts) {
    const double faster = contact.slide - report.path_scale * contact.source_slide;
    const double off = std::max(contact.height / kHigh, faster / kFast) / size;
    if (contact.end - contact.start < kLong || off < 1) continue;
    ++missed;
    if (off > most) most = off, worst = &contact;
  }
  if (worst == nullptr) return std::nullopt;
  return make_warning(
      "retarget-contact",
      fmt::format("{} of {} missed; worst: {} ({}) on {} from {} to {} s, height off by {} mm, "
                  "slides {} mm/s (the input's, scaled: {} mm/s)",
                  missed, counted(report.contacts.size(), "contact"), worst->part,
                  outcome.target.names[at(worst->joint)], worst->on, readable(worst->start, 3),
                  readable(worst->end, 3), readable(1e3 * worst->height, 3),
                  readable(1e3 * worst->slide, 3),
                  readable(1e3 * report.path_scale * worst->source_slide, 3)),
      why_missed(outcome, worst->part) + "krok-retarget -v lists all contacts");
}

// Feet that go deeper into the ground than the input's.
std::optional<Diagnostic> sunk_foot(const Outcome& outcome) {
  constexpr double kDeep = 0.02;  // metres
  const krok::retarget::FootReport* worst = nullptr;
  for (const auto* foot : {&outcome.report.left_foot, &outcome.report.right_foot}) {
    if (*foot && (worst == nullptr || (*foot)->largest_depth > worst->largest_depth)) {
      worst = &**foot;
    }
  }
  if (worst == nullptr || worst->largest_depth < kDeep) return std::nullopt;
  return make_warning(
      "retarget-sunk",
      fmt::format("{} goes {} deeper into the ground at {} s than the input's foot",
                  outcome.target.names[at(worst->largest_depth_joint)],
                  millimetres(worst->largest_depth), readable(worst->largest_depth_time, 3)),
      "feet that lie or kneel are placed as a whole; krok-edit --settle lays a "
      "motion on the ground");
}

// Likewise of hands and head.
std::optional<Diagnostic> sunk_hand_or_head(const Outcome& outcome) {
  constexpr double kDeep = 0.03;  // metres; tips of fingers are no more exact
  const krok::retarget::Report& report = outcome.report;
  if (report.largest_depth < kDeep) return std::nullopt;
  return make_warning(
      "retarget-sunk",
      fmt::format("{} goes {} deeper into the ground at {} s than the input's",
                  outcome.target.names[at(report.largest_depth_joint)],
                  millimetres(report.largest_depth), readable(report.largest_depth_time, 3)),
      "only hands that touch the ground are placed on it; krok-ik moves a hand");
}

// Legs that straighten and still miss a place of the input's foot.
std::optional<Diagnostic> short_legs(const krok::retarget::Report& report) {
  constexpr double kShort = 0.01;  // metres
  const krok::retarget::FootReport* worst = nullptr;
  for (const auto* foot : {&report.left_foot, &report.right_foot}) {
    if (*foot && (worst == nullptr || (*foot)->largest_miss > worst->largest_miss)) worst = &**foot;
  }
  if (worst == nullptr || worst->largest_miss < kShort) return std::nullopt;
  return make_warning(
      "retarget-reach",
      fmt::format("the legs are too short for the input's steps, the {} one by up to {} in frame "
                  "{}",
                  worst == &*report.left_foot ? "left" : "right", millimetres(worst->largest_miss),
                  worst->largest_miss_frame),
      "a smaller --scale makes the steps shorter");
}

}  // namespace

Diagnostics choices_of(const Outcome& outcome, bool pose_is_given) {
  Diagnostics choices;
  const krok::retarget::Report& report = outcome.report;
  const auto note = [&](std::string code, std::string message, std::string hint = {}) {
    Diagnostic diagnostic = make_warning(std::move(code), std::move(message), std::move(hint));
    diagnostic.severity = Severity::note;
    choices.push_back(std::move(diagnostic));
  };
  const std::vector<Transform>& reference = outcome.source.reference;
  if (!pose_is_given && outcome.source_roles.humanoid &&
      report.method == krok::retarget::Method::roles &&
      !krok::retarget::stands({outcome.source, outcome.source_roles, reference})) {
    note("retarget-stance",
         "the input's reference pose does not stand; a T-pose built from this take replaces it",
         "takes of an actor are aligned alike with --takes and --save-alignment, then --alignment");
    // Of people, and of toys, 0.25 at most; of dogs and elephants 0.37 and more.
    constexpr double kUnlikePeople = 0.3;
    const auto stature = stature_of(outcome.source, outcome.source_roles);
    if (stature && stature->uncertainty > kUnlikePeople * stature->metres) {
      choices.push_back(make_warning(
          "retarget-body",
          "the input's legs, spine and arms are not in a person's proportions, and its reference "
          "pose does not stand: perhaps a creature on four legs, moved as a person is",
          "leave it out, or give a target of its own kind"));
    }
  }
  const auto note_frame = [&](const std::optional<int>& frame, const char* whose) {
    if (!frame) return;
    note("retarget-reference",
         fmt::format("frame {} of the {} is used as its reference pose", *frame, whose));
  };
  note_frame(report.source_frame, "input");
  note_frame(report.target_frame, "target");
  double hips_turned = 0;
  for (const krok::retarget::MappedJoint& joint : report.mapped) {
    const Role role = outcome.target_roles.roles[at(joint.target)];
    if (role == Role::hips) hips_turned = joint.alignment;
    if (role == Role::head && joint.alignment > hips_turned + kPi / 2) {
      choices.push_back(make_warning(
          "retarget-head",
          fmt::format("{} is turned by {:.0f} deg against the hips to match the input's "
                      "reference pose: perhaps neck and head of another kind of rig",
                      outcome.target.names[at(joint.target)], to_degrees(joint.alignment)),
          "look at the result; krok-info -v shows the roles, --map and --onto-map of krok-retarget "
          "set them"));
    }
    if ((role != Role::left_foot && role != Role::right_foot) ||
        std::abs(joint.heading) < kTurnedFoot) {
      continue;
    }
    choices.push_back(make_warning(
        "retarget-foot",
        fmt::format("{} is turned by {:.0f} deg about the vertical against the input's",
                    outcome.target.names[at(joint.target)],
                    std::abs(joint.heading) / kRadiansPerDegree),
        "do the toes have the right roles? krok-info -v shows them, --map and --onto-map of "
        "krok-retarget set them"));
  }
  if (auto reach = short_legs(report)) choices.push_back(*std::move(reach));
  if (auto sunk = sunk_foot(outcome)) choices.push_back(*std::move(sunk));
  if (auto sunk = sunk_hand_or_head(outcome)) choices.push_back(*std::move(sunk));
  if (auto missed = missed_contacts(outcome)) choices.push_back(*std::move(missed));
  if (report.left_fingers_at_rest || report.right_fingers_at_rest) {
    note("retarget-fingers",
         "the input's fingers never move; the target's fingers keep their reference pose");
  }
  if (report.method == krok::retarget::Method::names) {
    note("retarget-names", "joints were mapped by name; foot contacts are not preserved");
  }
  return choices;
}

std::optional<double> floor_below(std::span<const Vec3f> mesh, const Skeleton& skeleton,
                                  const RoleMap& roles) {
  if (mesh.empty() || skeleton.empty() || !roles.humanoid) return std::nullopt;
  const auto height = [](const auto& point) { return static_cast<double>(point.y()); };
  const double floor = height(std::ranges::min(mesh, {}, height));
  double lowest = skeleton.reference.front().position.y();
  for (const Transform& joint : skeleton.reference) lowest = std::min(lowest, joint.position.y());
  const double under = lowest - floor;
  const bool near = under > -0.02 && under < 0.06 * reference_extent(skeleton);
  return near ? std::optional(floor) : std::nullopt;
}

}  // namespace krok::cli
