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

// FBX says up, front (what faces the viewer, which is where a figure looks) and unit.
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
              "the file says that its axes are left-handed; it is read as if they were not, and "
              "may come out mirrored");
    }
  } else {
    to.warn("assimp-axes", "the file does not say which of its axes point up and to the front");
  }
  float centimetres = 0;
  double precise = 0;
  if (data.Get("UnitScaleFactor", centimetres)) precise = static_cast<double>(centimetres);
  if (precise <= 0) data.Get("UnitScaleFactor", precise);
  if (precise > 0 && std::isfinite(precise)) {
    // A float of 2.54 is meant as 2.54.
    to.scene.space.metres = std::strtod(fmt::format("{:.7g}", precise).c_str(), nullptr) / 100;
  } else {
    to.warn("assimp-unit", "the file does not say what its unit of length is");
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
  // Assimp puts <unit> and <up_axis> into the root node. A figure faces +Z in a Y-up file, -Y in a
  // Z-up one, which then is +Z too, by custom and not by the format: that is left to be found.
  if (to.kind == Kind::collada && collada_has_unit(to.text)) to.scene.space.metres = 1.0;
}

}  // namespace krok::assimp
