#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/actor.h"
#include "scene/material.h"
#include "scene/scene.h"
#include "tools/cli/tool.h"
#include "tools/shared/bone_actor.h"

namespace krok::cli {

// Keyed by encoded image; null if it cannot be decoded.
using DecodedImages = std::map<const EncodedImage*, std::shared_ptr<const render::Mipmap>>;

// Decodes the base colour textures that are not in `known` yet, once each, and adds them. Warns,
// with `path` as location, if an image cannot be decoded (codes of image::decode; the surface keeps
// its plain colour) or is damaged (picture-damaged). `known` holds at most 2^28 pixels (1 GB) in
// total.
void decode_base_colours(std::span<const Material> materials, const std::string& path,
                         ToolContext& context, DecodedImages& known);

// Appearance of a surface with a material.
struct SurfaceLook {
  render::Colour colour;
  std::shared_ptr<const render::Paint> paint;  // null: the plain colour
};

using SharedCoordinates = std::shared_ptr<const std::vector<Vec2f>>;

// Textured if the image is in `images` and `coordinates`, the set of the base colour texture, is
// not null. Alpha cuts out texels: Material::Alpha::mask by its cutoff, blend below an alpha of
// 0.5. Empty if the whole surface is more transparent than that; such surfaces are not drawn, so
// that eyes are visible behind their cornea.
std::optional<SurfaceLook> look_of(const Material& material, const SharedCoordinates& coordinates,
                                   const DecodedImages& images);

struct DrawnSceneOptions {
  bool bones = false;  // the joints, even if there are meshes
  // Exporters write one grey for all meshes where nobody chose a colour: then the default body
  // colour is used.
  bool one_grey_is_none = false;
};

// A scene prepared for rendering: its meshes in the base colours, textures and vertex colours of
// their materials as look_of() has them, or its joints as bones if it has no triangles. A mesh
// without a material is light grey; where the scene has neither materials nor vertex colours, or
// look_of() leaves out all, everything has the default body colour.
class DrawnScene {
 public:
  DrawnScene(Scene scene, const DecodedImages& images, const DrawnSceneOptions& options = {});

  const Scene& scene() const { return scene_; }
  bool has_triangles() const { return has_triangles_; }
  bool as_bones() const { return bones_; }

  // Thread-safe. Without a centre.
  render::Actor at(const SceneState& state) const;

 private:
  void set_looks(const DecodedImages& images, bool one_grey_is_none);
  SharedCoordinates coordinates_of(const SceneMesh& mesh, int set) const;
  render::Surface surface(const SceneState& state, std::size_t mesh) const;

  Scene scene_;
  std::vector<std::shared_ptr<const render::Triangles>> triangles_;  // [meshes]
  std::vector<std::optional<SurfaceLook>> looks_;                    // [meshes]; empty: not drawn
  std::vector<std::vector<render::Colour>> vertex_colours_;          // [meshes][vertices] or none
  BoneStyle style_;
  bool bones_ = false, has_triangles_ = false;
};

}  // namespace krok::cli
