#pragma once

#include <assimp/scene.h>

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "formats/assimp/curve_internal.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"
#include "scene/material.h"

// Converts an aiScene to nodes::Scene, in steps. Runs in the child process: an invalid aiScene may
// crash it.

namespace krok::assimp {

// One of the helper nodes ("pivots") into which Assimp splits the transform of an FBX node.
struct ChainPart {
  std::string name;       // Assimp's
  std::string component;  // "Translation", "RotationPivot" and so on
  Mat4 matrix = Mat4::Identity();
};

struct Conversion {
  const aiScene& source;
  registry::Kind kind = registry::Kind::unknown;
  std::string_view text;         // the file itself
  double frames_per_second = 0;  // for formats that do not store it
  bool with_materials = false;
  nodes::Scene scene;

  std::unordered_map<const aiNode*, int> node_of;            // Assimp's node -> ours, if any
  std::unordered_map<std::string, int> node_by_name;         // the first of each name
  std::unordered_map<int, std::vector<ChainPart>> chain_of;  // of FBX nodes with helper nodes
  std::unordered_map<std::string, int> node_of_chain_part;   // helper's name -> ours

  void note(std::string code, std::string message, std::string hint = {});
  void warn(std::string code, std::string message, std::string hint = {});
};

// Thrown by the steps below if the file is unusable; the text is shown to the user.
struct ConversionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

Mat4 to_matrix(const aiMatrix4x4& matrix);  // throws if a number is not finite
Vec3 to_vector(const aiVector3D& vector);
std::string to_text(const aiString& text);

// Decomposes `matrix` into translation * rotation * scale. Returns whether this is exact within
// float rounding; fills in the closest values either way. A mirroring matrix gets a negative x
// scale.
bool take_apart(const Mat4& matrix, Vec3& translation, Quat& rotation, Vec3& scale);
Mat4 put_together(const Vec3& translation, const Quat& rotation, const Vec3& scale);

void convert_nodes(Conversion& conversion);
void convert_meshes(Conversion& conversion);   // after nodes
void convert_cameras(Conversion& conversion);  // after nodes
void mark_fixtures(Conversion& conversion);    // after nodes
void mark_bones(Conversion& conversion);       // after nodes
// After meshes. Animations of `source`: the conversion's scene, or one with the same nodes and
// meshes.
void convert_animations(Conversion& conversion, const aiScene& source);
void convert_space(Conversion& conversion);
void report_same_names(Conversion& conversion);
void report_takes(Conversion& conversion);
// How well the keys of `conversion` hold the file's curves, by what was resampled of them before.
void report_curves(Conversion& conversion, const std::optional<Resampling>& resampling);
void rename_collada_nodes(Conversion& conversion);    // last: other steps use Assimp's names
void report_what_is_missing(Conversion& conversion);  // last

// A material's name; its image's name if Assimp made the name up.
std::string material_name(const aiScene& source, unsigned index);

// Converts Assimp's materials. Embedded images have their bytes, others the path in the file. Runs
// in the child process.
class MaterialBuilder {
 public:
  explicit MaterialBuilder(Conversion& to) : to_(to) {}

  // Index in the scene of one of Assimp's materials, added if new; -1 for none.
  int index_of(unsigned material);

  // Warns about what was left out.
  void report();

 private:
  Material convert(const aiMaterial& source);
  Texture texture(const aiMaterial& source, aiTextureType type);
  Texture first_texture(const aiMaterial& source, std::initializer_list<aiTextureType> types);
  std::shared_ptr<const EncodedImage> image(const std::string& path);

  Conversion& to_;
  std::map<unsigned, int> places_;
  std::map<std::string, std::shared_ptr<const EncodedImage>> images_;  // by path
  std::size_t other_coordinates_ = 0, undecoded_ = 0, separate_ = 0;
};

}  // namespace krok::assimp
