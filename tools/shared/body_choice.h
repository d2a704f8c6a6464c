#pragma once

#include <string>

#include "body/body.h"
#include "tools/cli/one_of.h"
#include "tools/cli/tool.h"

namespace krok::cli {

// --body, for tools that show motions: the generated body for a motion without one. The meaning of
// automatic depends on the tool.
enum class BodyChoice : unsigned char { automatic, none, low, medium, high };

inline CommandOption add_body_option(CommandOptions& command, BodyChoice& choice,
                                     const std::string& description) {
  return command.add_option("--body", choice, description)
      .type_name("DETAIL")
      .transform(one_of<BodyChoice>({{"auto", BodyChoice::automatic},
                                     {"none", BodyChoice::none},
                                     {"low", BodyChoice::low},
                                     {"medium", BodyChoice::medium},
                                     {"high", BodyChoice::high}}))
      .default_str("auto");
}

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
