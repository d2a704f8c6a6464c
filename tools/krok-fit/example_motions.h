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
#include "tools/common/tool.h"

// The motions that the description of a library names, all of one skeleton, with their keys.

namespace krok::fit_tool {

// A motion of the list, with the entry that named it.
struct ExampleMotion {
  const library::ExampleEntry* entry = nullptr;
  std::string path;
  std::string name;  // for people
  Clip clip;
  bool has_keys = false;  // beside the motion, or named
  MotionKeys keys;
  std::optional<FoundContacts> found;
};

// A motion that was left out, and why.
struct RefusedClip {
  std::string path;
  Error error;
};

struct ExampleMotions {
  std::vector<ExampleMotion> motions;  // one or more; the description must outlive them
  Skeleton skeleton;                   // of all of them
  RoleMap roles;
  std::vector<RefusedClip> refused;
};

// Reads the motions of the description that is at `path`. Those of steps that are to be found get
// contacts, and all without keytimes of their own the keys beside them or found. A motion that does
// not fit is an Error, or with `keep_going` is told and left out. Codes: see read_library().
Result<ExampleMotions> read_example_motions(const library::LibraryDescription& description,
                                            const std::string& path, bool keep_going,
                                            ToolContext& context);

// The error with the place in the description that it comes from, unless it has one.
Error at_entry(Error error, const Location& place);

}  // namespace krok::fit_tool
