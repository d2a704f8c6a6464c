#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"

// What a step library is to be made of, as a text file that people write: what is measured, and the
// motions that are its examples. formats/library/SPEC.md describes it.

namespace krok::library {

enum class Side : unsigned char { left, right };

struct ParameterEntry {
  std::string name;                   // what users call it: "length"
  std::string measures;               // "step.length", "LeftHand.up@touch"
  std::optional<double> tolerance;    // metres, radians or seconds, > 0
  std::optional<double> least, most;  // the range that is asked for, least < most
  Location place;                     // of the entry
};

// A keytime given by hand.
struct KeytimeEntry {
  std::string name;
  ClipTime time;
};

struct ExampleEntry {
  std::string name;                    // for people; empty: after the clip
  std::string clip;                    // a path, with wildcards where `automatic`
  bool automatic = false;              // steps are found in it, otherwise it is one example
  std::optional<ClipTime> from, to;    // the part that counts
  std::string keys;                    // path of its keytimes; empty: beside the clip, or found
  std::vector<KeytimeEntry> keytimes;  // one for each of the library's, or none
  Location place;
};

struct LibraryDescription {
  std::string name;                   // for people; may be empty
  std::string skeleton;               // path of a motion or model; empty: the first example's
  std::string map;                    // path of a role map; may be empty
  Side swing = Side::left;            // the foot that steps
  bool mirror = false;                // steps of the other side count too, mirrored
  std::vector<std::string> keytimes;  // names, two or more; empty: those of a step
  std::optional<double> rate;         // frames a second of what is made, > 0
  // How many median deviations from the median a step found may be before it is left out, > 0.
  std::optional<double> outlier_deviations;
  // How close examples found may lie, as a share of the ranges; 0 keeps all.
  std::optional<double> spacing;
  std::vector<ParameterEntry> parameters;  // one to eight, names unique
  std::vector<ExampleEntry> examples;      // one or more
};

// `path` is for the places of entries and errors. Codes: json-syntax, json-limit,
// library-structure, library-value, each with line and column.
Result<LibraryDescription> read(std::string_view text, const std::string& path);

}  // namespace krok::library
