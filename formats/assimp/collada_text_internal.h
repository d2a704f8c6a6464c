#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

// What Assimp 5.2 leaves out of COLLADA files, found in their text.

namespace krok::assimp {

// The name of each <node> that has both an id, by which Assimp calls it, and a name.
std::map<std::string, std::string> collada_node_names(std::string_view text);

// The numbers in all <yfov> elements, degrees.
std::vector<double> collada_vertical_fields_of_view(std::string_view text);

// An <animation_clip>: a part of the file's animations, over a part of their time.
struct ColladaClip {
  std::string name;
  std::vector<std::string> animations;  // ids
  double start = 0;                     // seconds
  double end = 0;                       // not after the start: the file does not say
};

std::vector<ColladaClip> collada_clips(std::string_view text);

// The file with one <animation> instead of all those of the clip, or of all where it is null, and
// without clips. Exporters give each curve, or each joint, an <animation> of its own. Assimp 5.2
// joins those that are equally long and each move another node: curves of one node in several would
// each put the others' parts back to rest, and clips of one length become one. An empty string
// where nothing can be done: there are no animations, or samplers have the same id.
std::string collada_with_one_animation(std::string_view text, const ColladaClip* clip);

bool collada_has_unit(std::string_view text);

// Whether keys are joined by curves rather than straight lines.
bool collada_has_curves(std::string_view text);

}  // namespace krok::assimp
