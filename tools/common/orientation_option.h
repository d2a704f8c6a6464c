#pragma once

#include "formats/container/packed_orientation.h"
#include "tools/common/command_options.h"
#include "tools/common/option_kinds.h"

namespace krok {

// --orientation, for tools that write one of Krok's binary formats.
inline CommandOption add_orientation_option(CommandOptions& command,
                                            OrientationEncoding& encoding) {
  return add_choice<OrientationEncoding>(
             command, "--orientation", encoding,
             {{"xyz", OrientationEncoding::xyz}, {"xyzw", OrientationEncoding::xyzw}},
             "Quaternion storage: three components (xyz) or all four, exact (xyzw)", "HOW", "xyz")
      .group("Output");
}

}  // namespace krok
