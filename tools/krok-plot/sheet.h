#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/shared/image.h"
#include "tools/shared/moving_actor.h"
#include "tools/shared/shared_options.h"

// Rendered images: contact sheets and motion strips.

namespace krok::cli::plot {

// What counts as the front.
enum class Front : unsigned char {
  actor,  // the facing at the first time shown
  world   // +Z, the facing in the reference pose
};

struct SheetOptions {
  std::string sheet, strip;    // paths; empty for none
  std::optional<int> columns;  // actors side by side on the sheet
  ImageOptions image;
  bool size_given = false;  // otherwise smaller than image.size where the sheet would be too large
  std::optional<ClipTime> from, to;
  GroundChoice ground;  // empty: level at 0
  std::string prints;   // a file of footprints on it, or empty
  bool whole_ground = false;
  Front front = Front::actor;
  BodyChoice body = BodyChoice::automatic;
  SkinMethod method = SkinMethod::linear;
  std::string clip;  // of glTF files: a name or an index; empty: the first

  bool wanted() const { return !sheet.empty() || !strip.empty(); }
};

// Declares --sheet, --strip, --ground and their options, except --from and --to.
void declare_sheet(CommandOptions& command, SheetOptions& options, GroundChoice& ground);

// Renders the characters of all inputs, adds the requested images to the outputs and the report,
// and a line for each to `done`.
Status make_sheets(const std::vector<std::string>& inputs, const SheetOptions& options,
                   ToolContext& context, OutputSet& outputs, std::vector<std::string>& done);

}  // namespace krok::cli::plot
