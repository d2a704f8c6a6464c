#pragma once

#include <string>
#include <vector>

#include "formats/io/inputs.h"
#include "gait/path.h"

namespace krok::cli::walk {

// The way over the ground of an animated node of a glTF file, or of another scene, in its first
// animation. Without a name, of the first node that goes anywhere. Joints of skins sway with steps,
// which is taken out. Codes: those of reading the scene; path-node if there is no such node, or it
// stays where it is.
Result<std::vector<gait::PathPoint>> way_of_node(const InputFile& file, const std::string& name,
                                                 io::Inputs& inputs);

}  // namespace krok::cli::walk
