#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace krok::cli {

// Whether two paths refer to the same regular file, which need not exist yet. False for devices and
// standard streams, which can be read and written at once.
bool same_file(const std::string& first, const std::string& second);

// Device and inode number of a regular file; empty if there is none.
using FileNumber = std::pair<std::uint64_t, std::uint64_t>;
std::optional<FileNumber> file_number(const std::string& path);

// Canonical path of a regular file, with links resolved; the file need not exist. Empty for
// standard streams and devices.
std::string place_of(const std::string& path);

// Error (code usage): an output would overwrite this input.
Error replaced_error(const std::string& path);

// Error (code usage): two outputs have this path.
Error twice_error(const std::string& path);

// `path` if absolute, otherwise `path` relative to `folder`; an empty folder is the current one.
std::string below(const std::string& folder, const std::string& path);

// Absolute path without ".", ".." and double slashes; links are not resolved.
std::string absolute_path(const std::string& path);

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

// Hint for a file that is not there: one of like name beside it, among the first 1,000; a folder of
// its name without the ending; for "HEAD~1" and the like, how git compares commits. Reads the
// folder.
std::string missing_file_hint(const std::string& path);

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

// Keeps those of a folder's files that have one of the endings, in lower case with the dot. Names
// and counts the others of known formats (code folder-left-out): a warning if one may hold a
// motion, else a note; nothing if there are none. What is read with the motion beside it, such as
// an Acclaim skeleton, does not count. Where the endings are those of motions, a capture beside the
// .anim of its name is left out, too (a warning, code folder-twice): the take would count twice.
Diagnostics keep_inputs(const std::string& folder, const std::vector<std::string>& endings,
                        std::vector<std::string>& paths);

}  // namespace krok::cli
