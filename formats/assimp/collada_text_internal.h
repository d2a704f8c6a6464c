#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// Finds COLLADA data that Assimp 5.2 ignores, in the file's text.

namespace krok::assimp {

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

// Whether any keys have BEZIER or HERMITE interpolation.
bool collada_has_curves(std::string_view text);

}  // namespace krok::assimp
