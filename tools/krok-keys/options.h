#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "tools/common/command_options.h"

namespace krok::keys_tool {

enum class Find : unsigned char { automatic, steps, none };

struct Options {
  std::string input;
  std::string map;   // a file that tells joints' roles, or empty
  std::string keys;  // a file to begin with, or empty
  Find find = Find::automatic;
  bool discard_edits = false;
  std::vector<std::string> set, remove, add_contact, remove_contact;  // as typed
  std::string plot;
};

// Changes by hand, understood.
struct KeytimeChange {
  std::string name;
  std::optional<ClipTime> time;  // of one to be removed: nothing is all of that name
};
struct ContactChange {
  std::string joint;
  ClipTime from, to;  // of one to be removed: both a moment within it
};
struct Changes {
  std::vector<KeytimeChange> set, remove;
  std::vector<ContactChange> add_contact, remove_contact;

  bool empty() const {
    return set.empty() && remove.empty() && add_contact.empty() && remove_contact.empty();
  }
};

void declare(CommandOptions& command, Options& options);

// Code usage, or those of parse_clip_time, with the option's name.
Result<Changes> changes_of(const Options& options);
Status check(const Options& options);

}  // namespace krok::keys_tool
