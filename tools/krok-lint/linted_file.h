#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/io/open_role_map.h"
#include "lint/duplicates.h"
#include "lint/lint.h"
#include "terrain/terrain.h"
#include "tools/krok-lint/options.h"

namespace krok::cli::lint {

// What was found in one input.
struct LintedFile {
  std::string path;
  std::optional<Error> error;                 // why it cannot be read
  std::vector<krok::lint::Finding> findings;  // the worst first
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
};

// "0.063 m", with the unit that reads best: "63 mm".
std::string quantity_text(double value, const std::string& unit);
// "LeftFoot: 63 mm, limit 40 mm, 1.10 to 1.50 s".
std::string text_of(const krok::lint::Finding& finding, const LintedFile& file);

// How all motions are judged. `ground` may be null and must outlive the result.
krok::lint::MotionOptions judging(const Options& options, const krok::lint::Settings& settings,
                                  const Terrain* ground);

// Reads and judges all inputs, on the context's threads, in order.
std::vector<LintedFile> lint_all(const Options& options, const krok::lint::MotionOptions& how,
                                 const io::FindRoles& find_roles, ToolContext& context);

}  // namespace krok::cli::lint
