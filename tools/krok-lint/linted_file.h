#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/io/open_motion.h"
#include "formats/lint/lint.h"
#include "lint/lint.h"
#include "terrain/terrain.h"
#include "tools/cli/report.h"
#include "tools/krok-lint/options.h"

namespace krok::cli::lint {

// What was found in one input, or in one of its animations: a file with several has an element of
// its own for its meshes, and one for each animation after it.
struct LintedFile {
  std::string path;
  std::string animation;                      // empty for the only one
  std::optional<Error> error;                 // why it cannot be read
  std::vector<krok::lint::Finding> findings;  // the worst first
  std::vector<krok::lint::Finding> near;      // of lower limits, for baselines
  std::vector<std::string> notes;
  Diagnostics diagnostics;          // of the reader
  std::vector<std::string> joints;  // names
  double rate = 30;
  int frames = 0;
  krok::lint::Signature signature;
  std::size_t suppressed = 0, known = 0;  // findings that were left out

  // The joint's name, "hips" for the path of the body, empty for the whole body.
  std::string joint_of(const krok::lint::Finding& finding) const;
  double seconds(int frame) const { return frame / rate; }
  // "hero.glb: Run", for people.
  std::string name() const;
};

// "0.063 m", with the unit that reads best: "63 mm".
std::string quantity_text(double value, const std::string& unit);
// "LeftFoot: 63 mm, limit 40 mm, 1.10 to 1.50 s".
std::string text_of(const krok::lint::Finding& finding, const LintedFile& file);

// How all motions are judged. `ground` may be null and must outlive the result.
krok::lint::MotionOptions judging(const Options& options, const krok::lint::Settings& settings,
                                  const Terrain* ground);

// Faults of the motion of `file`, whose names may call it a loop.
krok::lint::MotionFaults faults_of(const Clip& clip, const RoleMap& roles, const LintedFile& file,
                                   const Options& options, const krok::lint::MotionOptions& how);

// Reads and judges all inputs, on the context's threads, in order.
std::vector<LintedFile> lint_all(const Options& options, const krok::lint::MotionOptions& how,
                                 const io::FindRoles& find_roles, ToolContext& context);

// Which faults do not count: those of a baseline and suppressed ones.

// A fault's identity: the file's name without folder and ending, with the animation, the rule, and
// the fault's number among those of the rule in order of time. Sixteen hexadecimal digits.
std::string fingerprint_of(const LintedFile& file, std::string_view rule, int number);
// Those of a file's findings, in their order.
std::vector<std::string> fingerprints_of(const LintedFile& file);

// What --save-baseline writes: faults, and what is nearly one.
std::vector<lint_files::KnownFault> known_faults(const std::vector<LintedFile>& files);

// Takes out findings of the same file name and rule that overlap one of the baseline's in time,
// within a quarter of a second: the worst joint of a fault and its ends may change when a motion is
// resampled, as may its value: what was nearly a fault hides those of less than twice their limit.
void leave_out_known(const std::vector<lint_files::KnownFault>& known, LintedFile& file);

// Takes out what the sidecar beside each motion, NAME.lint.json, suppresses. A sidecar that cannot
// be read is the error of its motion.
void leave_out_suppressed(LintedFile& file, ToolContext& context);

// Whether a file, `path`, names a rule of krok-lint; code lint-rule.
Status check_rule(const std::string& id, const std::string& path);

// Rules and limits of a profile on top of `settings`. Codes: those of reading it, and lint-rule.
Status apply_profile(const std::string& path, krok::lint::Settings& settings, ToolContext& context);

// What was found as text for people, tables and other programs. Files in the order given.

using LintedFiles = std::span<const LintedFile* const>;

// A line for each fault: "walk.bvh: 1.20 s: warning: LeftFoot: 63 mm, limit 40 mm [foot-slide]".
std::string console_text(const LintedFile& file, bool errors_only = false);
std::string rules_text();

std::string table_of(LintedFiles files);  // CSV
Json json_of(const LintedFile& file);     // for the tool's report

// SARIF 2.1.0 (OASIS): a result for each fault, with a fingerprint (krokLint/v1) that is the same
// under another name of its folder, export, rate or unit. GitHub shows at most 25,000 results a
// run, 5,000 of them: the worst are kept, and what is left out is counted.
std::string sarif_of(LintedFiles files, const std::string& version);

// JUnit XML: a test suite for each file, a failed test case for each rule with faults, a
// skipped one for each that `settings` leaves out.
std::string junit_of(LintedFiles files, const krok::lint::Settings& settings);

// Pages that play files, as links from another page.
using PlayerLinks = std::map<const LintedFile*, std::string>;

// An HTML page: a table of all faults, the worst file first, and for the worst fault of each file
// five images of the body around its worst moment, for the first 100 files. Times lead to the
// moment in the page that plays the file, if it has one.
Result<std::string> page_of(LintedFiles files, const PlayerLinks& players, ToolContext& context);

// A page that plays a file's motion, with its mesh if it has one.
Result<std::string> player_of(const LintedFile& file);

}  // namespace krok::cli::lint
