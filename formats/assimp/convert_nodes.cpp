#include <assimp/commonMetaData.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "core/text.h"
#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/fbx_elements_internal.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"

namespace krok::assimp {

using namespace nodes;

namespace {

constexpr std::string_view kHelperTag = "_$AssimpFbx$_";

bool is_helper(std::string_view name) {
  return name.find(kHelperTag) != std::string_view::npos;
}

std::string_view component_of(std::string_view name) {
  return name.substr(name.rfind(kHelperTag) + kHelperTag.size());
}

int add_node(Conversion& to, const std::string& name, int parent, const Mat4& matrix) {
  Node node;
  node.name = name;
  node.parent = parent;
  node.has_matrix = !take_apart(matrix, node.translation, node.rotation, node.scale);
  node.matrix = node.has_matrix ? matrix : Mat4::Identity();
  const int index = static_cast<int>(to.scene.nodes.size());
  to.scene.nodes.push_back(std::move(node));
  to.node_by_name.emplace(name, index);
  return index;
}

// FBX: T Roff Rp Rpre R Rpost Rp^-1 Soff Sp S Sp^-1 [geometric] node [geometric^-1] children.
// Everything before the geometric transform is the node's transform; the geometric transform
// applies to the node's meshes but not to its children.
struct Chain {
  std::vector<ChainPart> parts;
  Mat4 node_to_parent = Mat4::Identity();
  Mat4 geometry_to_node = Mat4::Identity();
  bool has_geometry = false;
  const aiNode* end = nullptr;  // the node itself
};

Chain follow_chain(const aiNode* node) {
  Chain chain;
  while (is_helper(node->mName.C_Str()) && node->mNumChildren == 1) {
    ChainPart part;
    part.name = node->mName.C_Str();
    part.component = component_of(part.name);
    part.matrix = to_matrix(node->mTransformation);
    if (part.component.starts_with("Geometric")) {
      chain.has_geometry = true;
      chain.geometry_to_node = chain.geometry_to_node * part.matrix;
    } else {
      chain.node_to_parent = chain.node_to_parent * part.matrix;
      chain.parts.push_back(std::move(part));
    }
    node = node->mChildren[0];
  }
  chain.end = node;
  return chain;
}

// FBX's InheritType, which is 0 of nodes that say nothing.
Node::ParentScale parent_scale_of(const aiNode& node) {
  int type = 0;
  if (node.mMetaData != nullptr) (void)node.mMetaData->Get("InheritType", type);
  if (type == 0) return Node::ParentScale::along_own_axes;
  return type == 2 ? Node::ParentScale::compensated : Node::ParentScale::inherited;
}

// The parent of the children, below the helpers that undo the geometric transform.
const aiNode* holder_of_children(const aiNode* node) {
  while (node->mNumChildren == 1 && is_helper(node->mChildren[0]->mName.C_Str()) &&
         component_of(node->mChildren[0]->mName.C_Str()).starts_with("Geometric") &&
         component_of(node->mChildren[0]->mName.C_Str()).ends_with("Inverse")) {
    node = node->mChildren[0];
  }
  return node;
}

}  // namespace

Mat4 to_matrix(const aiMatrix4x4& m) {
  Mat4 matrix;
  for (unsigned r = 0; r < 4; ++r) {
    for (unsigned c = 0; c < 4; ++c) matrix(r, c) = static_cast<double>(m[r][c]);
  }
  if (!matrix.allFinite()) throw ConversionError("a joint's transform is not finite");
  return matrix;
}

Vec3 to_vector(const aiVector3D& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

std::string to_text(const aiString& text) {
  const std::size_t size = std::min<std::size_t>(text.length, sizeof(text.data) - 1);
  return to_utf8(std::string_view(text.data, size));
}

Mat4 put_together(const Vec3& translation, const Quat& rotation, const Vec3& scale) {
  Mat4 matrix = Mat4::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix() * scale.asDiagonal();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

bool take_apart(const Mat4& matrix, Vec3& translation, Quat& rotation, Vec3& scale) {
  translation = matrix.topRightCorner<3, 1>();
  rotation = rigid_part(matrix).orientation;
  const Mat3 stretch = rotation.toRotationMatrix().transpose() * matrix.topLeftCorner<3, 3>();
  scale = stretch.diagonal();
  if (matrix.topLeftCorner<3, 3>().determinant() < 0) {
    // rigid_part negates all axes; mirroring along one axis is what users expect.
    rotation = rotation * Quat(Eigen::AngleAxisd(kPi, Vec3::UnitX()));
    const Mat3 again = rotation.toRotationMatrix().transpose() * matrix.topLeftCorner<3, 3>();
    scale = again.diagonal();
  }
  const double size = std::max(matrix.topLeftCorner<3, 3>().norm(), 1e-30);
  const double off = (put_together(translation, rotation, scale) - matrix).norm();
  constexpr double kFloatRounding = 2e-5;
  return off <= kFloatRounding * size;
}

void convert_nodes(Conversion& to) {
  struct Pending {
    const aiNode* node;
    int parent;
  };
  std::vector<Pending> pending{{to.source.mRootNode, -1}};
  while (!pending.empty()) {
    const auto [node, parent] = pending.back();
    pending.pop_back();
    const Chain chain = follow_chain(node);
    // From 5.4 on Assimp turns the root of FBX files by their axes; these are judged here as those
    // of all formats are.
    const bool turned = to.kind == registry::Kind::fbx && chain.end == to.source.mRootNode;
    const Mat4 own = turned ? Mat4(Mat4::Identity()) : to_matrix(chain.end->mTransformation);
    const std::string name = to_text(chain.end->mName);
    const int index = add_node(to, name, parent, chain.node_to_parent * own);
    if (!chain.parts.empty()) {
      for (const ChainPart& part : chain.parts) to.node_of_chain_part.emplace(part.name, index);
      to.chain_of[index] = chain.parts;
    }
    to.node_of[chain.end] = index;
    if (to.kind == registry::Kind::fbx) {
      to.scene.nodes.back().parent_scale = parent_scale_of(*chain.end);
    }
    if (chain.has_geometry && chain.end->mNumMeshes > 0) {
      to.node_of[chain.end] = add_node(to, name + "_geometry", index, chain.geometry_to_node);
    }
    const aiNode* holder = holder_of_children(chain.end);
    for (unsigned c = holder->mNumChildren; c-- > 0;) {
      pending.push_back({holder->mChildren[c], index});
    }
  }
}

// Assimp keeps which nodes are joints only of those that a mesh is weighted to.
void mark_bones(Conversion& to) {
  const auto names = to.kind == registry::Kind::fbx       ? fbx_limb_names(to.text)
                     : to.kind == registry::Kind::collada ? collada_joint_ids(to.text)
                                                          : std::set<std::string>();
  for (Node& node : to.scene.nodes) node.bone = names.contains(node.name);
}

using registry::Kind;

namespace {

std::optional<Vec3> axis_of(const aiMetadata& data, const char* axis_key, const char* sign_key) {
  int axis = -1;
  int sign = 0;
  if (!data.Get(axis_key, axis) || axis < 0 || axis > 2) return std::nullopt;
  if (!data.Get(sign_key, sign) || sign == 0) return std::nullopt;
  Vec3 direction = Vec3::Zero();
  direction[axis] = sign > 0 ? 1.0 : -1.0;
  return direction;
}

// FBX has the up axis, the front axis (towards the viewer, where a character faces) and the unit.
void convert_fbx_space(Conversion& to, const aiMetadata& data) {
  const auto up = axis_of(data, "UpAxis", "UpAxisSign");
  const auto front = axis_of(data, "FrontAxis", "FrontAxisSign");
  const auto side = axis_of(data, "CoordAxis", "CoordAxisSign");
  if (up && front && up->dot(*front) == 0.0) {
    Mat3 axes;  // columns: Krok's x, y, z in the file's axes
    axes << up->cross(*front), *up, *front;
    to.scene.space.file_to_krok = normalized_or_identity(Quat(axes).conjugate());
    if (side && side->dot(axes.col(0)) < 0) {
      to.warn("assimp-handedness",
              "the file has left-handed axes; they are read as right-handed, and the result may be "
              "mirrored");
    }
  } else {
    to.warn("assimp-axes", "the file does not specify its up and front axes");
  }
  float centimetres = 0;
  double precise = 0;
  if (data.Get("UnitScaleFactor", centimetres)) precise = static_cast<double>(centimetres);
  if (precise <= 0) data.Get("UnitScaleFactor", precise);
  if (precise > 0 && std::isfinite(precise)) {
    // Round the float to the decimal that was meant, such as 2.54.
    to.scene.space.metres = std::strtod(fmt::format("{:.7g}", precise).c_str(), nullptr) / 100;
  } else {
    to.warn("assimp-unit", "the file does not specify its unit of length");
  }
}

}  // namespace

void convert_space(Conversion& to) {
  const aiMetadata* data = to.source.mMetaData;
  aiString generator;
  if (data != nullptr && data->Get(AI_METADATA_SOURCE_GENERATOR, generator)) {
    to.scene.generator = to_text(generator);
  }
  if (to.kind == Kind::fbx && data != nullptr) convert_fbx_space(to, *data);
  // Assimp applies <unit> and <up_axis> to the root node. By convention a character faces +Z in
  // Y-up files and -Y in Z-up files, which becomes +Z. The format does not specify it; the facing
  // is detected later.
  if (to.kind != Kind::collada) return;
  if (collada_has_unit(to.text)) to.scene.space.metres = 1.0;
  to.scene.space.up_is_y = to.text.find("<up_axis>") != std::string_view::npos;
}

}  // namespace krok::assimp
