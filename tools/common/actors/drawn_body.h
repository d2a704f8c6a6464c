#pragma once

#include <memory>
#include <span>
#include <vector>

#include "math/transform.h"
#include "render/actor.h"
#include "scene/material.h"
#include "scene/model.h"
#include "skin/skin.h"
#include "tools/common/actors/surface_look.h"

namespace krok {

// A model as pictures show it. Without materials it has the colour of bodies. With materials its
// parts look as look_of() says, light grey where none of the materials is theirs. A model of parts
// that are all left out is drawn as if without materials.
class DrawnBody {
 public:
  DrawnBody(std::shared_ptr<const Model> model, std::span<const Material> materials,
            SkinMethod method, const DecodedImages& images = {});

  // Its surfaces in a pose of the model's joints. May be called by several threads.
  std::vector<render::Surface> at(std::span<const Transform> pose) const;

 private:
  struct Part {
    std::vector<std::uint32_t> vertices;                 // of the model, that it has; empty for all
    std::shared_ptr<const render::Triangles> triangles;  // of these
    SurfaceLook look;
  };
  Part part_of(const Model::Part& part) const;
  SharedCoordinates coordinates_of(const Part& part) const;

  std::shared_ptr<const Model> model_;
  SkinBinding binding_;
  std::vector<Part> parts_;                             // none: all in the colour of bodies
  std::shared_ptr<const render::Triangles> triangles_;  // where there are no parts
};

}  // namespace krok
