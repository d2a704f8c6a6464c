#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "core/result.h"
#include "formats/library/library_description.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"

// Loads the motions named in a library description, with their keys; all share one skeleton.

namespace krok::cli::fit {

// A motion and its entry in the description.
struct ExampleMotion {
  const library::ExampleEntry* entry = nullptr;
  std::string path;
  std::string name;  // for messages
  Clip clip;
  bool has_keys = false;  // a keytime file exists beside the motion or is named
  MotionKeys keys;
  std::optional<FoundContacts> found;
};

// A motion that was left out, and the reason.
struct RefusedClip {
  std::string path;
  Error error;
};

struct ExampleMotions {
  std::vector<ExampleMotion> motions;  // at least one; the description must outlive them
  Skeleton skeleton;                   // shared by all
  RoleMap roles;
  std::vector<RefusedClip> refused;
};

// Reads the motions of the description at `path`. Motions for step detection get contacts; those
// without keytimes of their own get the keys beside them or detected ones. An unsuitable motion is
// an Error, or with `keep_going` a warning, and left out. Codes: see read_library().
Result<ExampleMotions> read_example_motions(const library::LibraryDescription& description,
                                            const std::string& path, bool keep_going,
                                            ToolContext& context);

// Sets the error's location in the description, unless it has one.
Error at_entry(Error error, const Location& place);

}  // namespace krok::cli::fit
