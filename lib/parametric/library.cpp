#include "parametric/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "core/index.h"
#include "core/numbers.h"
#include "motion/hips_root.h"
#include "motion/mirror.h"
#include "motion/travel.h"
#include "parametric/measure.h"
#include "pose/packed_pose.h"

namespace krok::parametric {

namespace {

constexpr double kSameOffset = 0.01;  // of the skeleton's extent
constexpr double kShortest = 0.01;    // seconds
constexpr std::size_t kLongestName = 1000;

Error keytime_error(const std::string& name, std::string message) {
  return {"parametric-keytimes", fmt::format("{}: {}", name, std::move(message)),
          "krok-keys finds or sets keytimes"};
}

// What an example's keytimes must satisfy in this library.
Status check_keytimes(const Library& library, const std::string& name, const Clip& motion,
                      const std::vector<double>& times) {
  if (times.size() != library.keytimes.size()) {
    return keytime_error(name, fmt::format("has {} keytimes, the library has {}", times.size(),
                                           library.keytimes.size()));
  }
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!(times[k] >= -1e-9 && times[k] <= motion.duration() + 1e-9)) {
      return keytime_error(
          name, fmt::format("{} at {} s is outside the motion of {} s", library.keytimes[k],
                            readable(times[k]), readable(motion.duration())));
    }
    if (k == 0 || times[k] - times[k - 1] >= shortest_interval(library)) continue;
    return keytime_error(name,
                         fmt::format("{} s from {} to {} is too short, the min is {} s",
                                     readable(times[k] - times[k - 1]), library.keytimes[k - 1],
                                     library.keytimes[k], readable(shortest_interval(library), 3)));
  }
  return {};
}

Transform pose_of_joint(const Clip& motion, int joint, double time) {
  const PackedClip packed = pack_clip(motion);
  std::vector<PoseBlock> pose(static_cast<std::size_t>(packed.blocks_per_pose()));
  sample_pose(packed, time, pose);
  std::vector<Transform> local(motion.skeleton.names.size());
  unpack_pose(pose, local);
  local_to_world(motion.skeleton.parents, local, local);
  return local[static_cast<std::size_t>(joint)];
}

void move_contacts(const Transform& world_to_world, std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) contact.place = world_to_world * contact.place;
}

void sort_contacts(std::vector<Contact>& contacts) {
  std::ranges::stable_sort(contacts, [](const Contact& a, const Contact& b) {
    return a.start != b.start ? a.start < b.start : a.joint < b.joint;
  });
}

Error example_error(std::size_t index, std::string message) {
  return {"parametric-example", fmt::format("example {} {}", index + 1, std::move(message)),
          "make the library again"};
}

Status check_example(const Library& library, std::size_t index) {
  const Example& example = library.examples[index];
  if (example.name.empty() || example.name.size() > kLongestName) {
    return example_error(index, "has no name or one longer than 1,000 bytes");
  }
  if (example.motion.frame_count() == 0) return example_error(index, "has no frames");
  if (example.parameters.size() != library.parameters.size() ||
      !std::ranges::all_of(example.parameters, [](double p) { return std::isfinite(p); })) {
    return example_error(index, "has missing or invalid parameters");
  }
  if (Status status = check(example.motion); !status) return status;
  if (Status status = same_skeleton(library.skeleton, example.motion.skeleton); !status)
    return status;
  if (Status status = check({example.contacts, {}}, library.skeleton, example.motion.duration());
      !status) {
    return status;
  }
  return check_keytimes(library, example.name, example.motion, example.keytimes);
}

Status check_roles(const Library& library) {
  int last = -1;
  for (const GivenRole& given : library.given_roles) {
    if (given.joint <= last || given.joint >= library.skeleton.joint_count()) {
      return Error("parametric-roles",
                   "roles are given to joints twice, out of order or that do "
                   "not exist");
    }
    last = given.joint;
  }
  const auto roles = find_roles(library.skeleton, library.given_roles);
  return roles ? Status() : roles.error();
}

Vec3 image(const Vec3& v) {
  return {-v.x(), v.y(), v.z()};
}

// The sole of `foot` mirrored to its partner; `axes` from axes_to_images().
FootShape mirrored_foot(const FootShape& foot, const std::vector<Quat>& axes, int partner) {
  const auto across = [&](const Vec3& v) -> Vec3 {
    return axes[at(partner)].conjugate() * image(v);
  };
  return {partner, across(foot.heel), across(foot.forward), foot.length, -foot.toe_out};
}

// End sites off the feet that another skeleton has elsewhere, to where the library's are.
void place_end_sites(const Skeleton& library, Clip& motion) {
  constexpr float kElsewhere = 1e-4F;  // metres
  const std::vector<int> feet = foot_joints(library, find_roles(library));
  for (int j = 1; j < library.joint_count(); ++j) {
    if (library.end_sites[at(j)] == 0 || std::ranges::binary_search(feet, j)) continue;
    const Vec3f offset = library.reference_local(j).position.cast<float>();
    const std::size_t parent = at(library.parents[at(j)]);
    for (int f = 0; f < motion.frame_count(); ++f) {
      Vec3f& place = motion.frame_positions(f)[at(j)];
      const Vec3f ours =
          motion.frame_positions(f)[parent] + motion.frame_orientations(f)[parent] * offset;
      if ((ours - place).norm() > kElsewhere) place = ours;
    }
  }
}

}  // namespace

int carrying_joint(const Library& library) {
  return krok::carrying_joint(roles_of(library));
}

RoleMap roles_of(const Library& library) {
  auto roles = find_roles(library.skeleton, library.given_roles);
  return roles ? *std::move(roles) : find_roles(library.skeleton);
}

std::vector<GivenRole> given_roles(const RoleMap& map) {
  std::vector<GivenRole> result;
  for (std::size_t j = 0; j < map.given.size(); ++j) {
    if (map.given[j] != 0) result.push_back({static_cast<int>(j), map.roles[j], map.fingers[j]});
  }
  return result;
}

Library Library::with(std::vector<Example> others) const {
  return {.skeleton = skeleton,
          .given_roles = given_roles,
          .swing = swing,
          .feet = feet,
          .keytimes = keytimes,
          .parameters = parameters,
          .rate = rate,
          .examples = std::move(others),
          .ground = ground};
}

double shortest_interval(const Library& library) {
  return std::min(2 / library.rate, kShortest) * (1 - 1e-9);
}

Status same_skeleton(const Skeleton& library, const Skeleton& other) {
  constexpr const char* kRetarget = "krok-retarget transfers a motion to another skeleton";
  const std::string difference = difference_in_structure(library, other);
  if (!difference.empty()) {
    return Error("parametric-skeleton", "not the library's skeleton: " + difference, kRetarget);
  }
  const std::vector<int> feet = foot_joints(library, find_roles(library));
  const double allowed = kSameOffset * std::max(reference_extent(library), reference_extent(other));
  for (int j = 1; j < library.joint_count(); ++j) {
    const Vec3 ours = library.reference_local(j).position;
    const Vec3 theirs = other.reference_local(j).position;
    if ((ours - theirs).norm() <= allowed) continue;
    // The joints above the hips only place the character, and end sites off the feet only mark
    // where the last bone ends.
    if (library.end_sites[at(j)] != 0 && !std::ranges::binary_search(feet, j)) continue;
    if (subtree(library, j)[at(krok::carrying_joint(find_roles(library)))] != 0) continue;
    const std::string& name = library.names[static_cast<std::size_t>(j)];
    Error error("parametric-skeleton",
                fmt::format("not the library's skeleton: {} is offset by {} m in its parent's "
                            "frame",
                            name, readable((ours - theirs).norm(), 3)),
                kRetarget);
    error.joint = name;
    return error;
  }
  return {};
}

Result<Example> make_example(const Library& library, std::string name, const Clip& motion,
                             std::vector<double> keytimes, std::vector<Contact> contacts) {
  if (Status status = same_skeleton(library.skeleton, motion.skeleton); !status)
    return status.error();
  if (Status status = check_keytimes(library, name, motion, keytimes); !status)
    return status.error();
  const FootShape& stance = library.foot(library.stance());
  const Footprint print = footprint(stance, pose_of_joint(motion, stance.joint, keytimes.front()));
  const Transform to_stance = print.to_world().inverse();

  Example example;
  example.name = std::move(name);
  example.ground = print.place.y();
  example.motion = motion;
  example.motion.skeleton = library.skeleton;
  example.motion.provenance = {};
  place_end_sites(library.skeleton, example.motion);
  move_clip(to_stance, example.motion);
  example.keytimes = std::move(keytimes);
  example.contacts = std::move(contacts);
  move_contacts(to_stance, example.contacts);
  sort_contacts(example.contacts);

  const Library alone = library.with({example});
  const Measure measure(alone, pack_examples(alone));
  auto scratch = measure.make_scratch();
  example.parameters.resize(library.parameters.size());
  const double all = 1;
  if (Status status = measure({&all, 1}, example.parameters, {}, scratch); !status) {
    return std::move(status).error().in_file(example.name);
  }
  return example;
}

// Detected steps have a number and a foot after the name of their capture.
std::string_view capture_of(std::string_view example) {
  std::string_view rest = example;
  if (rest.ends_with(" left") || rest.ends_with(" right")) {
    rest.remove_suffix(rest.size() - rest.rfind(' '));
    const std::size_t space = rest.rfind(' ');
    if (space == std::string_view::npos) return example;
    int number = 0;
    const auto parsed = std::from_chars(rest.data() + space + 1, rest.data() + rest.size(), number);
    if (parsed.ec == std::errc() && parsed.ptr == rest.data() + rest.size()) {
      return rest.substr(0, space);
    }
  }
  return example;
}

std::vector<int> captures_of(const Library& library) {
  std::map<std::string_view, int> numbers;
  std::vector<int> captures;
  for (const Example& example : library.examples) {
    const auto added =
        numbers.emplace(capture_of(example.name), static_cast<int>(numbers.size())).first;
    captures.push_back(added->second);
  }
  return captures;
}

double ground_of(const Library& library) {
  constexpr double kLevel = 0.05;  // metres
  std::vector<double> heights;
  for (const Example& example : library.examples) heights.push_back(example.ground);
  if (heights.empty()) return 0;
  std::ranges::sort(heights);
  if (heights.back() - heights.front() > kLevel) return 0;
  return heights[heights.size() / 2];
}

Footprint print_at(const FootShape& foot, const Clip& motion, double time) {
  return footprint(foot, pose_of_joint(motion, foot.joint, time));
}

Status check(const Library& library) {
  if (Status status = check(library.skeleton); !status) return status;
  if (Status status = check_roles(library); !status) return status;
  for (const FootShape& foot : library.feet) {
    if (foot.joint >= 0 && foot.joint < library.skeleton.joint_count() && foot.heel.allFinite() &&
        foot.length >= 0 && std::isfinite(foot.length) && std::isfinite(foot.toe_out) &&
        std::abs(foot.forward.norm() - 1) <= 1e-4) {
      continue;
    }
    return Error("parametric-feet", "a foot has no joint or no sole", "make the library again");
  }
  if (library.keytimes.size() < 2 ||
      std::ranges::any_of(library.keytimes, [](const auto& name) { return name.empty(); })) {
    return Error("parametric-keytimes", "a library needs at least two named keytimes");
  }
  if (!std::isfinite(library.ground)) {
    return Error("parametric-example", "the height of the ground is not a number");
  }
  if (Status status = check_frame_rate(library.rate, "clip-rate"); !status) return status;
  if (Status status = check(library.parameters, library.skeleton, library.keytimes); !status) {
    return status;
  }
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    if (Status status = check_example(library, i); !status) return status;
  }
  return {};
}

Result<Library> mirrored(const Library& library) {
  const MirrorPairs pairs = find_mirror_pairs(library.skeleton, roles_of(library));
  const auto partner = [&](int joint) { return pairs.partners[static_cast<std::size_t>(joint)]; };
  std::vector<Transform> posture;
  if (!library.examples.empty()) posture = usual_pose(library.examples.front().motion);
  const std::vector<Quat> axes = axes_to_images(library.skeleton, pairs, posture);
  Library result = library;
  result.swing = library.stance();
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const FootShape& foot = library.foot(side);
    if (partner(foot.joint) == MirrorPairs::kNone || partner(foot.joint) == foot.joint) {
      return Error("parametric-feet", "the feet are not each other's mirror image",
                   "assign them with --map");
    }
    result.feet[1 - static_cast<std::size_t>(side)] =
        mirrored_foot(foot, axes, partner(foot.joint));
  }
  for (Parameter& parameter : result.parameters) {
    if (parameter.joint < 0) continue;
    parameter.joint = partner(parameter.joint);
    if (parameter.joint == MirrorPairs::kNone) {
      return Error("parametric-feet", "a measured joint has no mirror image",
                   "assign the joints with --map");
    }
  }
  for (Example& example : result.examples) {
    example.motion = mirror(example.motion, pairs, posture);
    example.motion.skeleton = library.skeleton;
    example.mirrored = !example.mirrored;
    std::erase_if(example.contacts, [&](const Contact& contact) {
      return partner(contact.joint) == MirrorPairs::kNone;
    });
    for (Contact& contact : example.contacts) {
      contact.joint = partner(contact.joint);
      contact.place = image(contact.place);
    }
    sort_contacts(example.contacts);
  }
  return result;
}

}  // namespace krok::parametric
