#pragma once

#include <string>

#include "body/body.h"
#include "tools/cli/tool.h"

namespace krok::cli {

// --body, for tools that show motions: the generated body for a motion without one. The meaning of
// automatic depends on the tool.
enum class BodyChoice : unsigned char { automatic, none, low, medium, high };

// Options for generating the body; `choice` is low, medium or high.
inline BodyOptions body_options(BodyChoice choice, const ToolContext& context) {
  BodyOptions how;
  how.detail = choice == BodyChoice::low      ? BodyDetail::low
               : choice == BodyChoice::medium ? BodyDetail::medium
                                              : BodyDetail::high;
  how.jobs = context.jobs;
  how.progress = context.progress;
  return how;
}

}  // namespace krok::cli
