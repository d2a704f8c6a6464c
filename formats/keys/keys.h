#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/motion_keys.h"

// Contacts and keytimes beside a motion, as a text file that tools write and people edit:
// NAME.keys.json; SPEC.md describes it.

namespace krok::keys {

// All that such a file holds.
struct Sidecar {
  MotionKeys keys;
  // 1 for what a person set, shape [contacts] and [keytimes]; empty stands for all 0.
  std::vector<std::uint8_t> contacts_by_hand, keytimes_by_hand;

  // Whether a person changed what no mark shows: took something out by a tool, which then says so,
  // or wrote into the file, so that its checksum differs.
  bool edited = false;

  // Of the motion it was made for, seconds; 0 where the file does not tell.
  double duration = 0;

  // Whether a person had a hand in it at all.
  bool has_edits() const;
};

// The keys alone. `path` is for messages; `duration` is the motion's, in seconds. Contacts and
// keytimes are brought in order. Codes, each with line and column: json-syntax, json-limit,
// keys-structure, keys-value, keys-joint (no joint has that name), keys-time (outside the motion,
// an end before its start, two keytimes at one moment).
Result<MotionKeys> read(std::string_view text, const std::string& path, const Skeleton& skeleton,
                        double duration);

// The same with all else that the file holds.
Result<Sidecar> read_sidecar(std::string_view text, const std::string& path,
                             const Skeleton& skeleton, double duration);

// The file's text. `keys` must pass check(). Times are rounded to a microsecond (keytimes
// kept at least two apart), places to a hundredth of a millimetre. The same keys give the same
// bytes.
std::string write(const MotionKeys& keys, const Skeleton& skeleton, double duration);

// The same with marks of what is set by hand. Where `edited` is set, the file says so.
std::string write_sidecar(const Sidecar& sidecar, const Skeleton& skeleton);

}  // namespace krok::keys
