#include "tools/shared/keys_sidecar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "contacts/long_take.h"
#include "contacts/loop_steps.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/anim/anim.h"
#include "tools/cli/paths.h"

namespace krok::cli {

namespace {

constexpr double kFar = 0.05;  // metres; feet in contact slide by less

// The median distance, in metres, of the contacts' places from where the motion has their joints;
// 0 without contacts. What cannot be read is an error where all frames are.
double distance_of_contacts(const MotionKeys& keys, const FrameSource& motion) {
  std::vector<Vec3f> places(motion.skeleton.names.size());
  std::vector<Quatf> turns(places.size());
  std::vector<double> distances;
  for (const Contact& contact : keys.contacts) {
    const int frame = middle_frame(contact, motion.rate, motion.frame_count);
    if (!motion.read(frame, 1, places, turns)) continue;
    const Vec3 place = places[static_cast<std::size_t>(contact.joint)].cast<double>();
    distances.push_back((place - contact.place).norm());
  }
  if (distances.empty()) return 0;
  const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, half);
  return *half;
}

// How it shows that keys were made for another motion; nothing if it does not.
std::string sign_of_another_motion(const krok::keys::Sidecar& sidecar, const FrameSource& motion) {
  // Half a frame: more than rounding errors, less than any cut.
  if (sidecar.duration > 0 && std::abs(sidecar.duration - motion.duration()) > 0.5 / motion.rate) {
    return fmt::format("made for a motion of {} s, but this one has {} s",
                       readable(sidecar.duration), readable(motion.duration()));
  }
  const double away = motion.frame_count > 0 ? distance_of_contacts(sidecar.keys, motion) : 0;
  if (away <= kFar) return {};
  return fmt::format("made for another motion: its contacts are {:.0f} mm (median) from the joints",
                     1e3 * away);
}

}  // namespace

std::string keys_sidecar_path(const std::string& motion_path) {
  if (motion_path == "-" || motion_path.empty()) return {};
  return path_without_ending(motion_path) + ".keys.json";
}

Result<krok::keys::Sidecar> read_keys_file(const std::string& path, const FrameSource& motion,
                                           ToolContext& context) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  auto sidecar = krok::keys::read_sidecar(input->text(), path, motion.skeleton, motion.duration());
  if (!sidecar && sidecar.error().code == "json-syntax" && sidecar.error().hint.empty()) {
    Error error = std::move(sidecar).error();
    error.hint = "krok-keys writes the contacts of a motion, NAME.keys.json beside NAME.anim";
    return error;
  }
  if (!sidecar) return sidecar;
  if (std::string sign = sign_of_another_motion(*sidecar, motion); !sign.empty()) {
    context.diagnose_in(path, {make_warning("keys-stale", std::move(sign),
                                            "if the motion was changed, run krok-keys again")});
  }
  return sidecar;
}

Result<std::optional<krok::keys::Sidecar>> read_keys_beside(const std::string& motion_path,
                                                            const FrameSource& motion,
                                                            ToolContext& context) {
  const std::string path = keys_sidecar_path(motion_path);
  if (path.empty()) return std::optional<krok::keys::Sidecar>();
  context.depends_on_neighbours(motion_path, base_name(path));
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::optional<krok::keys::Sidecar>();
  const auto input = context.open_input(path);
  if (!input) return input.error();
  auto sidecar = krok::keys::read_sidecar(input->text(), path, motion.skeleton, motion.duration());
  const std::string sign = sidecar ? sign_of_another_motion(*sidecar, motion) : std::string();
  if (sidecar && sign.empty()) return std::optional<krok::keys::Sidecar>(std::move(*sidecar));
  const bool stale =
      sidecar || sidecar.error().code == "keys-joint" || sidecar.error().code == "keys-time";
  if (!stale) return std::move(sidecar).error();
  if (krok::keys::has_edits(input->text())) {
    auto edited = read_keys_file(path, motion, context);
    if (!edited) return std::move(edited).error();
    return std::optional<krok::keys::Sidecar>(std::move(*edited));
  }
  context.diagnose_in(
      path, {make_warning("keys-stale",
                          fmt::format("not used, since {}",
                                      sidecar ? "it was " + sign : sidecar.error().message),
                          "it was not edited by hand; krok-keys rebuilds it")});
  return std::optional<krok::keys::Sidecar>();
}

Result<MotionKeys> find_keys(const std::string& path, const Clip& clip, const RoleMap& roles,
                             ToolContext& context) {
  auto steps = find_steps(clip, roles);
  if (!steps) return std::move(steps).error();
  const Location before = std::exchange(context.subject, Location{.file = path});
  context.diagnose(steps->contacts.warnings);
  context.diagnose(steps->gait.warnings);
  context.subject = before;
  return MotionKeys{std::move(steps->contacts.contacts), std::move(steps->gait.keytimes)};
}

Json to_json(std::span<const Keytime> keytimes) {
  Json list = Json::array();
  for (const Keytime& key : keytimes) list.push_back({{"name", key.name}, {"time", key.time}});
  return list;
}

void warn_of_lost_speed(const std::string& name, const Clip& clip, ToolContext& context) {
  const auto& removed = clip.provenance.removed_root_motion;
  if (!removed) return;
  context.warn("motion-in-place",
               fmt::format("{} is in place; the speed of {} m/s that was taken out of it is lost",
                           name, readable(removed->velocity.norm(), 3)),
               "combine the motions first, then make a loop of the result: krok-edit --game-loop");
}

Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              const std::string& name, const Clip& clip,
                                              const io::FindRoles& find_roles,
                                              ToolContext& context) {
  std::optional<MotionKeys> none;
  if (choice == KeysChoice::none) return none;
  auto sidecar = read_keys_beside(path, clip, context);
  if (!sidecar) return sidecar.error();
  if (*sidecar) return std::optional(std::move((*sidecar)->keys));
  if (choice == KeysChoice::sidecar) {
    return Error("keys-missing",
                 fmt::format("{} is missing beside it", base_name(keys_sidecar_path(path))),
                 "create it with krok-keys, or use --contacts auto to detect keytimes")
        .in_file(path);
  }
  const auto roles = find_roles(clip.skeleton);
  if (!roles) return roles.error();
  auto found = find_keys(path, clip, *roles, context);
  if (!found) {
    context.warn("keys-none", fmt::format("{}: {}", name, found.error().message));
    return none;
  }
  return std::optional(std::move(*found));
}

Status add_keys(const MotionKeys& keys, const Skeleton& skeleton, double duration,
                const std::string& motion_path, OutputSet& outputs) {
  const std::string path = keys_sidecar_path(motion_path);
  if (keys.empty() || path.empty()) return {};
  std::error_code unknown;
  if (std::filesystem::exists(path, unknown)) {
    const auto file = InputFile::open(path);
    if (!file) return file.error();
    if (krok::keys::has_edits(file->text())) {
      return Error("keys-edited", "was edited by hand, or is not a keytime file",
                   "the result's keytimes would overwrite it: move it away, or choose another name "
                   "for the result")
          .in_file(path);
    }
  }
  return outputs.add(path, krok::keys::write(keys, skeleton, duration));
}

Status add_motion(const Clip& clip, const MotionKeys& keys, OrientationEncoding orientation,
                  const std::string& path, int jobs, OutputSet& outputs) {
  Status status = outputs.add(path, [&](OutputFile& file) {
    return anim::write(clip, {.orientation = orientation, .jobs = thread_count(jobs)}, file);
  });
  return status ? add_keys(keys, clip.skeleton, clip.duration(), path, outputs) : status;
}

Result<std::optional<MotionKeys>> choose_keys(KeysChoice choice, const std::string& path,
                                              std::size_t bytes, const FrameSource& frames,
                                              const Provenance& provenance,
                                              const io::FindRoles& find_roles, ToolContext& context,
                                              bool contacts_alone) {
  const std::optional<MotionKeys> none;
  if (choice == KeysChoice::none) return none;
  const std::string name = name_of_input(path);
  if (bytes < kLongTake || provenance.removed_root_motion) {
    auto clip = load(frames, context.jobs);
    if (!clip) return clip.error();
    clip->provenance = provenance;
    return choose_keys(choice, path, name, *clip, find_roles, context);
  }
  auto beside = read_keys_beside(path, frames, context);
  if (!beside) return beside.error();
  if (*beside) return std::optional(std::move((*beside)->keys));
  if (choice == KeysChoice::sidecar) {  // the error for a file that is missing
    const Clip empty{frames.skeleton, frames.rate, {}, {}, {}};
    return choose_keys(choice, path, name, empty, find_roles, context);
  }
  const auto roles = find_roles(frames.skeleton);
  if (!roles) return roles.error();
  auto take = find_in_long_take(frames, *roles, context.jobs, context.progress,
                                {.contacts_alone = contacts_alone});
  if (!take && take.error().code != "contacts-feet") return take.error();
  if (!take) {
    context.warn("keys-none", fmt::format("{}: {}", name, take.error().message));
    return none;
  }
  context.diagnose_in(path, take->warnings);
  return std::optional(std::move(take->keys));
}

}  // namespace krok::cli
