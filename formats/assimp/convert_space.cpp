#include <assimp/commonMetaData.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "math/quaternion.h"

namespace krok::assimp {

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
