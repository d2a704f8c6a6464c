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
#include "scene/motion_keys.h"

// Types and functions shared by all readers of motion captures.

namespace krok {

// How to handle a damaged file. normal: unambiguous data is read; the rest is dropped with a
// warning, or is an error. strict: any defect in the data is an error. repair: damaged data is
// dropped or filled from its neighbours, and each repair is listed. The reader of each format
// documents the details.
enum class Strictness { normal, strict, repair };

// Conventions given by the user, and how to read the file.
struct CaptureOptions : GivenConventions {
  Strictness strictness = Strictness::normal;

  // Joint roles given by the user. Called with the skeleton in the file's unit and axes, with the
  // same joint names as the result. An Error is passed on by the reader. Empty: find_roles.
  std::function<Result<RoleMap>(const Skeleton& skeleton)> roles;

  // Frames per second; overrides the file's rate.
  std::optional<double> rate;

  int jobs = 0;  // threads, as in parallel_for; does not affect the result
  Progress* progress = nullptr;

  // Limits against files crafted to exhaust memory.
  int max_joints = 65536;
  // Max ratio of the motion's memory to the size of its text; real files stay below 15.
  double max_expansion = 64.0;
};

struct Capture {
  // In Krok's frame; each format's reader documents its joints. The reference pose is upright and
  // faces +Z, even if its axes in the file differ from the motion's. provenance.conversions holds
  // unit and axes; the caller sets the rest of the provenance.
  Clip clip;

  // Notes and warnings: every choice, anomaly and repair.
  Diagnostics diagnostics;

  // The joint roles from which the conventions were detected.
  RoleMap roles;

  // The conventions the file was read with.
  Conventions conventions;

  MotionKeys keys;  // contacts stored in the file, if any

  Choice exporter;                   // the program that wrote the file; empty if unknown
  Choice rate;                       // where the frame rate comes from
  std::vector<std::string> repairs;  // what was dropped or filled, one line each
};

// The roles a reader uses: those of the options, otherwise from find_roles.
Result<RoleMap> roles_of(const Skeleton& skeleton, const CaptureOptions& options);

// An Error with `code` if `rate` is given but not positive and finite.
Status check_rate(const std::optional<double>& rate, const std::string& code);

}  // namespace krok
