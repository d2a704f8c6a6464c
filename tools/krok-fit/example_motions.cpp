#include "tools/krok-fit/library_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "contacts/gait_keytimes.h"
#include "core/glob.h"
#include "core/numbers.h"
#include "formats/io/open_motion.h"
#include "motion/sample.h"
#include "parametric/library.h"
#include "tools/cli/paths.h"
#include "tools/shared/keys_sidecar.h"

// Loads the motions named in a library description, with their keys; all share one skeleton.

namespace krok::cli::fit {

namespace {

using library::ExampleEntry;
using library::LibraryDescription;

class MotionReader {
 public:
  MotionReader(const LibraryDescription& description, const std::string& path, bool keep_going,
               ToolContext& context)
      : description_(description), path_(path), keep_going_(keep_going), context_(context) {}

  Result<ExampleMotions> read() {
    Status status = read_motions();
    if (status) status = keep_one_skeleton();
    if (status) status = find_all_keys();
    if (!status) return status.error();
    return std::move(made_);
  }

 private:
  std::string place_of(const std::string& name) const {
    return below(std::filesystem::path(path_).parent_path().string(), name);
  }

  // An unsuitable motion is an error, or with --keep-going a warning.
  Status refuse(const ExampleMotion& motion, Error error) {
    if (error.where.file.empty()) error.where.file = motion.path;
    if (!keep_going_) {
      error.hint += fmt::format("{}--keep-going leaves it out", error.hint.empty() ? "" : "; ");
      return error;
    }
    Diagnostic diagnostic = error;
    diagnostic.severity = Severity::warning;
    diagnostic.hint = "left out";
    context_.diagnose(std::move(diagnostic));
    made_.refused.push_back({motion.path, std::move(error)});
    return {};
  }

  Status read_motions() {
    std::error_code unknown;
    for (const ExampleEntry& entry : description_.examples) {
      std::vector<std::string> paths = {place_of(entry.clip)};
      // A file may be called take[1].bvh.
      if (has_wildcards(entry.clip) && !std::filesystem::exists(paths.front(), unknown)) {
        auto found = find_files(paths.front());
        if (!found) return found.error();
        paths = *std::move(found);
        // Patterns may also match keytime files beside the motions.
        std::erase_if(paths, [](const std::string& path) { return path.ends_with(".json"); });
        if (paths.empty()) {
          return at_entry(Error("library-clip", fmt::format("no file matches '{}'", entry.clip),
                                "paths are relative to this file"),
                          entry.place);
        }
      }
      for (const std::string& path : paths) {
        ExampleMotion motion;
        motion.entry = &entry;
        motion.path = path;
        motion.name = entry.name.empty() ? base_name(path) : entry.name;
        if (Status status = read_clip(motion); !status) {
          if (Status gone_on = refuse(motion, status.error()); !gone_on) return gone_on;
          continue;
        }
        made_.motions.push_back(std::move(motion));
      }
    }
    if (!made_.motions.empty()) return {};
    return Error("library-examples", "no usable motions").in_file(path_);
  }

  Status read_clip(ExampleMotion& motion) {
    // A jump from a rest pose is never part of a detected step.
    auto clip =
        io::open_motion(motion.path, context_, {.rest_frame_is_note = motion.entry->automatic});
    if (!clip) return clip.error();
    if (clip->frame_count() < 2) {
      return Error("library-examples", fmt::format("{} contains no motion", motion.name));
    }
    const ExampleEntry& entry = *motion.entry;
    auto sidecar = read_sidecar(motion, *clip);
    if (!sidecar) return sidecar.error();
    const int last_frame = clip->frame_count() - 1;
    const auto frame_of = [&](const std::optional<ClipTime>& time, int otherwise) {
      if (!time) return otherwise;
      return static_cast<int>(std::lround(
          std::min(time->seconds(clip->rate) * clip->rate, static_cast<double>(last_frame))));
    };
    const int first = frame_of(entry.from, 0), last = frame_of(entry.to, last_frame);
    if (first >= last) {
      return Error("library-examples",
                   fmt::format("the range from {} s to {} s contains no motion",
                               readable(first / clip->rate), readable(last / clip->rate)));
    }
    if (*sidecar) {
      motion.has_keys = true;
      motion.keys = part_of((*sidecar)->keys, first / clip->rate, last / clip->rate);
    }
    motion.clip = first == 0 && last == last_frame ? *std::move(clip) : cut(*clip, first, last);
    return {};
  }

  // Uses the named skeleton or the most common one; refuses motions on others.
  Status keep_one_skeleton() {
    if (description_.skeleton.empty()) {
      made_.skeleton = most_common_skeleton();
    } else {
      auto named = io::open_motion(place_of(description_.skeleton), context_);
      if (!named) return named.error();
      made_.skeleton = std::move(named->skeleton);
    }
    std::vector<ExampleMotion> kept;
    for (ExampleMotion& motion : made_.motions) {
      Status status = parametric::same_skeleton(made_.skeleton, motion.clip.skeleton);
      if (status) {
        kept.push_back(std::move(motion));
        continue;
      }
      Error error = std::move(status).error();
      error.hint = "krok-retarget transfers the motion to the library's skeleton";
      if (Status step = refuse(motion, std::move(error)); !step) return step;
    }
    made_.motions = std::move(kept);
    if (made_.motions.empty()) {
      return Error("library-examples", "no motion has the library's skeleton").in_file(path_);
    }
    const auto find_roles =
        io::open_role_map(description_.map.empty() ? "" : place_of(description_.map), context_);
    if (!find_roles) return find_roles.error();
    auto roles = (*find_roles)(made_.skeleton);
    if (!roles) return roles.error();
    made_.roles = *std::move(roles);
    return {};
  }

  Skeleton most_common_skeleton() const {
    std::size_t best = 0;
    int most = 0;
    for (std::size_t i = 0; i < made_.motions.size(); ++i) {
      const auto alike = std::ranges::count_if(made_.motions, [&](const ExampleMotion& other) {
        return parametric::same_skeleton(made_.motions[i].clip.skeleton, other.clip.skeleton).ok();
      });
      if (alike <= most) continue;
      most = static_cast<int>(alike);
      best = i;
    }
    return made_.motions[best].clip.skeleton;
  }

  Status find_all_keys() {
    for (ExampleMotion& motion : made_.motions) {
      if (!motion.entry->keytimes.empty()) continue;
      if (Status status = find_keys_of(motion); !status) return status;
    }
    return {};
  }

  Status find_keys_of(ExampleMotion& motion) {
    if (motion.entry->automatic) {
      auto contacts = find_contacts(motion.clip, made_.roles);
      if (!contacts) return std::move(contacts).error().in_file(motion.path);
      motion.found = *std::move(contacts);
    }
    if (motion.has_keys) return {};
    if (!motion.found) {
      auto keys = krok::cli::find_keys(motion.path, motion.clip, made_.roles, context_);
      if (!keys) return std::move(keys).error().in_file(motion.path);
      motion.keys = *std::move(keys);
      return {};
    }
    Gait gait = find_gait(motion.clip, made_.roles, *motion.found);
    context_.diagnose_in(motion.path, gait.warnings);
    motion.keys = {motion.found->contacts, std::move(gait.keytimes)};
    return {};
  }

  // Its times refer to the whole motion.
  Result<std::optional<keys::Sidecar>> read_sidecar(const ExampleMotion& motion,
                                                    const Clip& whole) {
    if (!motion.entry->keytimes.empty()) return std::optional<keys::Sidecar>();
    if (motion.entry->keys.empty()) return read_keys_beside(motion.path, whole, context_);
    auto sidecar = read_keys_file(place_of(motion.entry->keys), whole, context_);
    if (!sidecar) return std::move(sidecar).error();
    return std::optional<keys::Sidecar>(*std::move(sidecar));
  }

  const LibraryDescription& description_;
  const std::string& path_;
  bool keep_going_;
  ToolContext& context_;
  ExampleMotions made_;
};

}  // namespace

Result<ExampleMotions> read_example_motions(const LibraryDescription& description,
                                            const std::string& path, bool keep_going,
                                            ToolContext& context) {
  return MotionReader(description, path, keep_going, context).read();
}

Error at_entry(Error error, const Location& place) {
  if (error.where.file.empty()) error.where = place;
  return error;
}

}  // namespace krok::cli::fit
