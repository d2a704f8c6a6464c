#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "render/actor.h"
#include "scene/scene.h"
#include "tools/shared/bone_actor.h"
#include "tools/shared/surface_look.h"

namespace krok::cli {

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
