#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"

// Finds COLLADA data that Assimp 5.2 ignores, in the file's text.

namespace krok::assimp {

// The value of an attribute of a tag; empty if there is none.
std::string attribute(std::string_view tag, std::string_view name);

// Calls `use` with each tag of this name, and with the text after it.
template <typename Use>
void for_each_tag(std::string_view text, std::string_view opening, Use use) {
  for (std::size_t at = text.find(opening); at != std::string_view::npos;
       at = text.find(opening, at + 1)) {
    const std::size_t after = at + opening.size();
    if (after >= text.size()) return;
    if (!is_space(text[after]) && text[after] != '>' && text[after] != '/') continue;
    const std::size_t end = text.find('>', at);
    if (end == std::string_view::npos) return;
    use(text.substr(at, end - at), text.substr(end + 1));
  }
}

// Maps ids of <node> elements, which Assimp uses as names, to their names; nodes with both only.
std::map<std::string, std::string> collada_node_names(std::string_view text);

// Names in Assimp (id, sid or name) of <node> elements of type JOINT.
std::set<std::string> collada_joint_ids(std::string_view text);

// The vertical field of view, degrees, of the camera at each node, by the node's id, sid and name.
std::map<std::string, double> collada_fields_of_view(std::string_view text);

// An <animation_clip>: some of the file's animations, over a time range.
struct ColladaClip {
  std::string name;
  std::vector<std::string> animations;  // ids
  double start = 0;                     // seconds
  double end = 0;                       // not specified if not after the start
};

std::vector<ColladaClip> collada_clips(std::string_view text);

// The file with all <animation> elements of the clip (of the file, if null) merged into one, and
// without clips. Exporters write one <animation> per curve or joint. Assimp 5.2 merges those of
// equal duration that animate different nodes: a node's curves in several elements would each reset
// the others' components to rest, and clips of equal duration would become one. Empty if this is
// not possible: there are no animations, or samplers share an id.
std::string collada_with_one_animation(std::string_view text, const ColladaClip* clip);

bool collada_has_unit(std::string_view text);

}  // namespace krok::assimp
