#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"

namespace krok::cli::keys {

enum class Find : unsigned char { automatic, steps, none };

// Manual edits.
struct KeytimeChange {
  std::string name;
  std::optional<ClipTime> time;  // if not set in a removal: all keytimes of that name
};
struct ContactChange {
  std::string joint;
  ClipTime from, to;
};
struct Changes {
  std::vector<KeytimeChange> set, remove;
  bool new_names = false;  // of `set`: names that no keytime has are wanted
  std::vector<ContactChange> add_contact;
  std::vector<KeytimeChange> remove_contact;  // a joint and a time within its contact

  bool empty() const {
    return set.empty() && remove.empty() && add_contact.empty() && remove_contact.empty();
  }
};

struct Options {
  std::vector<std::string> inputs;  // several for `table` alone
  std::string map;                  // path of a role map, or empty
  std::string keys;                 // path of the initial keytime file, or empty
  Find find = Find::automatic;
  bool discard_edits = false;
  Changes changes;
  std::string plot;
  std::string table;

  const std::string& input() const { return inputs.front(); }
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::keys
