#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"

namespace krok::cli::keys {

enum class Find : unsigned char { automatic, steps, none };

struct Options {
  std::string input;
  std::string map;   // path of a role map, or empty
  std::string keys;  // path of the initial keytime file, or empty
  Find find = Find::automatic;
  bool discard_edits = false;
  std::vector<std::string> set, remove, add_contact, remove_contact;  // unparsed
  bool new_names = false;                                             // --new
  std::string plot;
};

// Parsed manual edits.
struct KeytimeChange {
  std::string name;
  std::optional<ClipTime> time;  // if not set in a removal: all keytimes of that name
};
struct ContactChange {
  std::string joint;
  ClipTime from, to;  // in a removal both are a time within it
};
struct Changes {
  std::vector<KeytimeChange> set, remove;
  bool new_names = false;  // of `set`: names that no keytime has are wanted
  std::vector<ContactChange> add_contact, remove_contact;

  bool empty() const {
    return set.empty() && remove.empty() && add_contact.empty() && remove_contact.empty();
  }
};

void declare(CommandOptions& command, Options& options);

// Code: usage, or those of parse_clip_time, with the option's name.
Result<Changes> changes_of(const Options& options);
Status check(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::keys
