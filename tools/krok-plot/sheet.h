#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/actors/image.h"
#include "tools/common/actors/moving_actor.h"
#include "tools/common/tool.h"

// Pictures of the figures themselves: contact sheets and motion strips.

namespace krok::plot {

// What "front" is.
enum class Front : unsigned char {
  actor,  // where the figure faces at the first moment shown
  world   // +Z, where figures face in their reference pose
};

struct SheetOptions {
  std::string sheet, strip;  // paths; empty for none
  ImageOptions image;
  std::string from, to;
  Front front = Front::actor;
  BodyChoice body = BodyChoice::automatic;
  SkinMethod method = SkinMethod::linear;

  bool wanted() const { return !sheet.empty() || !strip.empty(); }
};

// --sheet, --strip and what belongs to them, but --from and --to.
void declare_sheet(CommandOptions& command, SheetOptions& options);

// Draws the figures of all inputs into the pictures that are wanted, writes these and notes them in
// the report.
Status make_sheets(const std::vector<std::string>& inputs, const SheetOptions& options,
                   ToolContext& context);

}  // namespace krok::plot
