#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "core/result.h"
#include "formats/library/library_description.h"
#include "parametric/cut_steps.h"
#include "parametric/library.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"

// Builds a library from its description and motions.

namespace krok::cli::fit {

// A motion and its entry in the description.
struct ExampleMotion {
  const library::ExampleEntry* entry = nullptr;
  std::string path;
  std::string name;  // for messages
  Clip clip;
  bool has_keys = false;  // a keytime file exists beside the motion or is named
  MotionKeys keys;
  std::optional<FoundContacts> found;
};

// A motion that was left out, and the reason.
struct RefusedClip {
  std::string path;
  Error error;
};

struct ExampleMotions {
  std::vector<ExampleMotion> motions;  // at least one; the description must outlive them
  Skeleton skeleton;                   // shared by all
  RoleMap roles;
  std::vector<RefusedClip> refused;
};

// Reads the motions of the description at `path`. Motions for step detection get contacts; those
// without keytimes of their own get the keys beside them or detected ones. An unsuitable motion is
// an Error, or with `keep_going` a warning, and left out. Codes: see read_library().
Result<ExampleMotions> read_example_motions(const library::LibraryDescription& description,
                                            const std::string& path, bool keep_going,
                                            ToolContext& context);

// Sets the error's location in the description, unless it has one.
Error at_entry(Error error, const Location& place);

struct LibraryInput {
  library::LibraryDescription description;
  RoleMap roles;
  parametric::Library library;
  std::vector<double> lower, upper;  // [parameters], the requested range
  std::vector<parametric::DroppedStep> dropped;
  int found = 0;  // examples before thinning out
  // Of examples nearer to each other than this, in parameters scaled by their ranges, weights that
  // interpolate use one.
  double exact_spacing = 0;
  // All examples, if the description gives no spacing.
  std::vector<parametric::Example> all_examples;
  int mirrored = 0;             // number of mirrored examples
  Json styles = Json::array();  // see name_styles(): spreads in metres
  std::vector<RefusedClip> refused;
};

// Reads the description that is the one input, and the motions, relative to its folder; or motions
// that are the inputs, as if described by the lengths and turns of their steps. An unsuitable
// motion, such as one on another skeleton, is an Error, or with `keep_going` a warning, and left
// out. Codes: those of library::read and of reading motions; library-clip for a pattern without
// matches; library-keytimes, library-examples; those of parametric::cut_steps and make_example.
Result<LibraryInput> read_library(const std::vector<std::string>& inputs, bool keep_going,
                                  ToolContext& context);

// Spacing of detected steps that weights interpolate, and of examples that they smooth.
inline constexpr double kUsualSpacing = 0.15;
inline constexpr double kSmoothedSpacing = 1e-3;
// That of libraries made before, which may be continued.
inline constexpr double kFormerSmoothedSpacing = 0.01;

// Uses the examples with another spacing, or those of smoothed weights, unless the description
// gives a spacing.
void take_examples(LibraryInput& input, double spacing);
void take_smoothed_examples(LibraryInput& input);

// Gives examples without a style that of their group of captures, if the spread of their steps is
// that of several people or moods; a warning names the groups. A group is named after a word that
// its captures' names have and others lack, if there is one. Sets `input.styles`, for the report.
// Codes: those of parametric::group_styles().
Status name_styles(LibraryInput& input, ToolContext& context);

}  // namespace krok::cli::fit
