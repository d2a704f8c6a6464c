#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ik/limits.h"
#include "ragdoll/get_up.h"
#include "ragdoll/simulate.h"
#include "terrain/terrain.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/options.h"

// One fall of a motion, as far as standing again.

namespace krok::cli::ragdoll {

constexpr double kCoverDistance = 0.03;  // metres

// What all falls of a run have in common.
struct Subject {
  Clip clip;
  RoleMap roles;
  krok::ik::Limits limits;
  std::vector<krok::ragdoll::Body> bodies;
  std::vector<krok::ragdoll::JointRule> rules;  // of a file of bodies
  std::optional<double> covered;  // share of a model's vertices within kCoverDistance of a body
  // Motions to get up with, and their names; none: what falls stays there.
  std::vector<Clip> rises;
  std::vector<std::string> rise_names;
  std::shared_ptr<const Terrain> terrain;
};

struct Fallen {
  Clip clip;
  krok::ragdoll::Fall fall;                       // without its clip
  std::optional<krok::ragdoll::RisenClip> risen;  // without its clip
  bool undisturbed = false;   // follows the motion at full strength, without pushes
  double depth_at_start = 0;  // metres in the ground, of the deepest body
};

// Thread-safe. Codes: ragdoll-moving if it is to get up but does not come to rest, ragdoll-through
// if it ends below all ground by more than its height, and those of lib/ragdoll.
Result<Fallen> make_fall(const Subject& subject, const krok::ragdoll::FallOptions& options);

// What the fall misses: a code, a message without the fall's name, and what to do. Empty if it
// keeps all tolerances: at rest, limits exceeded by at most 1 degree and the ground entered by at
// most 5 cm at first and 5 mm after the first 0.2 s, an undisturbed motion followed within 5
// degrees, getting up with a motion that begins lying, within 1.5 x its acceleration and 1 cm of
// the ground.
std::vector<Error> faults_of(const Fallen& fallen);

// The measures for the report.
Json report_of(const Subject& subject, const Fallen& fallen);

// "a fall from 1.20 s, at rest after 2.34 s, up again at 6.10 s".
std::string summary_of(const Subject& subject, const krok::ragdoll::FallOptions& options,
                       const Fallen& fallen);

// The motion, its roles, ranges and bodies, and motions to get up with. Errors name the file that
// they are of; a mesh that the bodies do not fill prints a warning (ragdoll-model).
Result<Subject> read_subject(const Options& options, ToolContext& context);

// A fall of a table: a row.
struct TableFall {
  std::string name;       // unique
  std::string file_name;  // from the name, unique
  ClipTime at;
  PushAt push;
  Location at_place, joint_place, time_place;  // for messages
};

// Reads a CSV table with a header: name, at (seconds), joint, x, y, z (newton seconds), and maybe
// time (seconds); units may be given as in "at [ms]". `path` is for messages. Codes, with line and
// column: those of csv::Table; pushes-column (a column that is not known, missing, twice there or
// has a unit of another kind), pushes-value (an empty cell, a number out of range, or none),
// pushes-name (a name twice there).
Result<std::vector<TableFall>> read_push_table(std::string_view text, const std::string& path);

}  // namespace krok::cli::ragdoll
