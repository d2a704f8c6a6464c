#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/convention_choice.h"
#include "capture/conventions.h"
#include "core/progress.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"

// What readers of motion captures have in common, whatever the format.

namespace krok {

// What to do with a file that is not quite right. normal: what can be read without a doubt is, and
// the rest is left out with a warning, or is an error. strict: whatever would be a fault in the
// data is an error. repair: faults are left out or filled from their neighbours; each repair is
// listed. The reader of a format says what that means there.
enum class Strictness { normal, strict, repair };

// What the file is written in, where the user says so, and how to read it.
struct CaptureOptions : GivenConventions {
  Strictness strictness = Strictness::normal;

  // What the joints are, where the user says so. Called with the skeleton as the file has it, whose
  // names are those of the result; its Error is the reader's. Empty: find_roles.
  std::function<Result<RoleMap>(const Skeleton& skeleton)> roles;

  // Frames a second, whatever the file says.
  std::optional<double> rate;

  int jobs = 0;  // threads, as in parallel_for; the result does not depend on it
  Progress* progress = nullptr;

  // Limits against files that are made to exhaust memory.
  int max_joints = 65536;
  // The largest ratio of the memory for the motion to the size of its text; real files stay
  // under 15.
  double max_expansion = 64.0;
};

struct Capture {
  // In Krok's frame; what the joints are, the reader of the format says. In the reference pose the
  // figure stands upright and faces +Z, also where the file's axes for it are not the motion's.
  // provenance.conversions tells unit and axes; the rest of it is left to the caller.
  Clip clip;

  // Notes and warnings: every choice, every oddity, every repair.
  Diagnostics diagnostics;

  // What the joints are, as the conventions were worked out by.
  RoleMap roles;

  // What the file was taken to be written in.
  Conventions conventions;

  Choice exporter;                   // which program wrote the file; empty where none is known
  Choice rate;                       // where the rate comes from
  std::vector<std::string> repairs;  // what was left out or filled, a line each
};

// The roles that a reader goes by: as the options have them, otherwise as find_roles has them.
Result<RoleMap> roles_of(const Skeleton& skeleton, const CaptureOptions& options);

// Whether `rate`, if given, is positive and finite; an Error with `code` otherwise.
Status check_rate(const std::optional<double>& rate, const std::string& code);

}  // namespace krok
