#pragma once

#include <assimp/scene.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "formats/registry/registry.h"
#include "nodes/scene.h"

// From Assimp's scene to nodes::Scene, in steps that each fill in their part. Run in the child: a
// damaged aiScene may crash them.

namespace krok::assimp {

// One of the helper nodes into which Assimp splits the transform of an FBX node.
struct ChainPart {
  std::string name;       // Assimp's
  std::string component;  // "Translation", "RotationPivot" and so on
  Mat4 matrix = Mat4::Identity();
};

struct Conversion {
  const aiScene& source;
  registry::Kind kind = registry::Kind::unknown;
  std::string_view text;         // the file itself
  double frames_per_second = 0;  // for formats that count frames without saying how fast
  bool with_materials = false;
  nodes::Scene scene;

  std::unordered_map<const aiNode*, int> node_of;     // Assimp's node -> ours, where it has one
  std::unordered_map<std::string, int> node_by_name;  // the first of each name
  std::unordered_map<int, std::vector<ChainPart>> chain_of;  // of FBX nodes with helper nodes
  std::unordered_map<std::string, int> node_of_chain_part;   // helper's name -> ours

  void note(std::string code, std::string message, std::string hint = {});
  void warn(std::string code, std::string message, std::string hint = {});
};

// What makes a file unreadable, thrown by the steps below; the text goes to the user.
struct ConversionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Mat4 to_matrix(const aiMatrix4x4& matrix);  // throws where a number is not finite
Vec3 to_vector(const aiVector3D& vector);
std::string to_text(const aiString& text);

// Whether `matrix` is translation * rotation * scale to within float rounding; fills them in as
// near as they come either way. A mirroring matrix gets a negative scale along x.
bool take_apart(const Mat4& matrix, Vec3& translation, Quat& rotation, Vec3& scale);
Mat4 put_together(const Vec3& translation, const Quat& rotation, const Vec3& scale);

void convert_nodes(Conversion& conversion);
void convert_meshes(Conversion& conversion);   // after nodes
void convert_cameras(Conversion& conversion);  // after nodes
// After meshes: those of `source`, which is the conversion's own scene or one with the same nodes
// and meshes.
void convert_animations(Conversion& conversion, const aiScene& source);
void convert_space(Conversion& conversion);
void report_same_names(Conversion& conversion);
void report_layers(Conversion& conversion);
void rename_collada_nodes(Conversion& conversion);    // last: others go by Assimp's names
void report_what_is_missing(Conversion& conversion);  // last

}  // namespace krok::assimp
