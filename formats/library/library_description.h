#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"

// Description of a step library, the hand-written input of krok-fit: the parameters, and the
// motions that are its examples. See formats/library/SPEC.md.

namespace krok::library {

enum class Side : unsigned char { left, right };

// What is detected in the examples: steps of walks or runs, first steps out of standing, last steps
// into it, or standing; steps backward; steps to the side and turns on the spot, of the foot that
// leads or of the one that closes up.
enum class StepKind : unsigned char {
  walks,
  runs,
  starts,
  stops,
  stands,
  backward,
  side,
  side_closing,
  turns,
  turns_closing
};

struct ParameterEntry {
  std::string name;                   // for users: "length"
  std::string measures;               // "step.length", "LeftHand.up@touch"
  std::optional<double> tolerance;    // metres, radians or seconds, > 0
  std::optional<double> least, most;  // the requested range, least < most
  Location place;                     // of the entry
};

// A keytime given by hand.
struct KeytimeEntry {
  std::string name;
  ClipTime time;
};

struct ExampleEntry {
  std::string name;                    // for users; empty: that of the clip
  std::string clip;                    // a path, may have wildcards
  std::string style;                   // a person, a mood; empty: not known
  bool automatic = false;              // detect steps in it; otherwise it is one example
  std::optional<ClipTime> from, to;    // the part to use
  std::string keys;                    // path of its keytimes; empty: its sidecar, or detected
  std::vector<KeytimeEntry> keytimes;  // one for each keytime of the library, or none
  Location place;
};

struct LibraryDescription {
  std::string name;                   // for users; may be empty
  std::string skeleton;               // path of a motion or model; empty: the first example's
  std::string map;                    // path of a role map; may be empty
  Side swing = Side::left;            // the swing foot
  StepKind kind = StepKind::walks;    // of detected steps
  bool mirror = false;                // use steps of the other side too, mirrored
  std::vector<std::string> keytimes;  // names, at least two; empty: those of a step
  std::optional<double> rate;         // frames per second of generated motions, > 0
  // Detected steps further than this from the median, in median deviations, are dropped, > 0.
  std::optional<double> outlier_deviations;
  // Min distance of detected examples, as a fraction of the ranges; 0 keeps all.
  std::optional<double> spacing;
  std::vector<ParameterEntry> parameters;  // one to eight, names unique
  std::vector<ExampleEntry> examples;      // at least one
};

// `path` is for the locations of entries and errors. Codes: json-syntax, json-limit,
// library-structure, library-value, each with line and column.
Result<LibraryDescription> read(std::string_view text, const std::string& path);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::library
