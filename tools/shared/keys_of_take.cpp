#include "tools/shared/keys_of_take.h"

#include <fmt/format.h>

#include "contacts/long_take.h"
#include "tools/cli/file_name.h"

namespace krok::cli {

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
