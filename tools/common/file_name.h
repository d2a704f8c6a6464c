#pragma once

#include <string>

namespace krok {

// A name (of an animation, a shape) as the name of a file: without characters that separate folders
// or that shells and other systems mind, not hidden, not an option, at most 100 bytes.
std::string file_name_of(const std::string& name);

// An input as people are told of it: "walk.bvh" of its path, "standard input" for "-".
std::string name_of_input(const std::string& path);

}  // namespace krok
