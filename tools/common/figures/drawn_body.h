#pragma once

#include <memory>
#include <span>
#include <vector>

#include "math/transform.h"
#include "render/figure.h"
#include "scene/material.h"
#include "scene/model.h"
#include "skin/skin.h"

namespace krok {

// A model as pictures show it. Without materials it has the colour of bodies. With materials its
// parts have their base colours, light grey where none of the materials is theirs; pictures on them
// are not drawn, and parts that let through more than half of the light are left out, so that eyes
// are seen behind their cornea. A model of such parts alone is drawn as if without materials.
class DrawnBody {
 public:
  DrawnBody(std::shared_ptr<const Model> model, std::span<const Material> materials,
            SkinMethod method);

  // Its surfaces in a pose of the model's joints. May be called by several threads.
  std::vector<render::Surface> at(std::span<const Transform> pose) const;

 private:
  struct Part {
    std::vector<std::uint32_t> vertices;                 // of the model, that it has; empty for all
    std::shared_ptr<const render::Triangles> triangles;  // of these
    render::Colour colour;
  };
  Part part_of(const Model::Part& part, render::Colour colour) const;

  std::shared_ptr<const Model> model_;
  SkinBinding binding_;
  std::vector<Part> parts_;                             // none: all in the colour of bodies
  std::shared_ptr<const render::Triangles> triangles_;  // where there are no parts
};

}  // namespace krok
