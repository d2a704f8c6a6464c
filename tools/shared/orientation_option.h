#pragma once

#include "formats/container/packed_orientation.h"
#include "tools/cli/command_options.h"
#include "tools/cli/option_kinds.h"

namespace krok::cli {

// --orientation, for tools that write one of Krok's binary formats.
inline CommandOption add_orientation_option(CommandOptions& command,
                                            OrientationEncoding& encoding) {
  return add_choice<OrientationEncoding>(
             command, "--orientation", encoding,
             {{"xyz", OrientationEncoding::xyz}, {"xyzw", OrientationEncoding::xyzw}},
             "Quaternion storage: three components (xyz) or all four, exact (xyzw)", "HOW", "xyz")
      .group("Output");
}

}  // namespace krok::cli
