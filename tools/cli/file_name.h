#pragma once

#include <string>

namespace krok::cli {

// Turns a name (of an animation, a shape) into a file name: no path separators, no characters that
// are special in shells, obeyed by terminals or invalid on other systems, no leading dot or dash,
// at most 100 bytes.
std::string file_name_of(const std::string& name);

// A path with slashes as a relative URI reference (RFC 3986).
std::string uri_of(const std::string& path);

// The same path with another ending: "takes/walk.html" for "takes/walk.bvh", "takes.html" for the
// folder "takes/"; empty for "-".
std::string beside(const std::string& path, const std::string& ending);

// The path without its ending, for the names of what is made of a motion: "takes/walk" for
// "takes/walk.bvh", "takes/hero_Run" for the animation "takes/hero.glb#Run".
std::string path_without_ending(const std::string& path);

// Display name of an input: the base name, "walk.bvh", or "standard input" for "-".
std::string name_of_input(const std::string& path);

// The name of a motion in a file of several: "walk" for "takes/walk.anim", "Run" for
// "hero.glb#Run", "motion" for "-". UTF-8.
std::string clip_name_of(const std::string& path);

// "walk=takes/a.anim": the file takes/a.anim, to be called walk. Without a name, or for a file
// whose path is the whole text, `name` is empty.
struct NamedPath {
  std::string name;  // UTF-8
  std::string path;
};
NamedPath named_path(const std::string& text);

}  // namespace krok::cli
