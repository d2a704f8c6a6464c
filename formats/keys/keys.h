#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/motion_keys.h"

// Sidecar file with contacts and keytimes of a motion, NAME.keys.json: written by tools, editable
// by hand; see SPEC.md.

namespace krok::keys {

// The content of a sidecar file.
struct Sidecar {
  MotionKeys keys;
  // 1 for entries set by hand, shape [contacts] and [keytimes]; empty means all 0.
  std::vector<std::uint8_t> contacts_by_hand, keytimes_by_hand;

  // Whether there are edits without marks: something was removed with a tool, which sets this, or
  // the file was edited, so that its checksum differs.
  bool edited = false;

  // Duration of the motion it was made for, seconds; 0 if not in the file.
  double duration = 0;

  // Whether it was edited by hand in any way.
  bool has_edits() const;
};

// Reads only the keys. `path` is for messages; `duration` is the motion's, in seconds. Contacts and
// keytimes are sorted. Codes, each with line and column: json-syntax, json-limit,
// keys-structure, keys-value, keys-joint (no joint has that name), keys-time (outside the motion,
// an end before its start, two keytimes at the same time).
Result<MotionKeys> read(std::string_view text, const std::string& path, const Skeleton& skeleton,
                        double duration);

// The same with all other content of the file.
Result<Sidecar> read_sidecar(std::string_view text, const std::string& path,
                             const Skeleton& skeleton, double duration);

// Whether the file, of whatever motion, was edited by hand; true if it cannot be read.
bool has_edits(std::string_view text);

// The text of the file. `keys` must pass check(). Times are rounded to 1 us (keytimes are kept at
// least 2 us apart), contact positions to 0.01 mm. Deterministic.
std::string write(const MotionKeys& keys, const Skeleton& skeleton, double duration);

// The same with `edited` and the marks of entries set by hand.
std::string write_sidecar(const Sidecar& sidecar, const Skeleton& skeleton);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::keys
