#pragma once

#include <memory>
#include <span>
#include <vector>

#include "math/transform.h"
#include "render/actor.h"
#include "scene/material.h"
#include "scene/model.h"
#include "skin/skin.h"
#include "tools/shared/surface_look.h"

namespace krok::cli {

// A model prepared for rendering. Without materials and vertex colours it has the default body
// colour. With them,
// parts are drawn as look_of() returns, light grey if their material is missing. If look_of() drops
// all parts, the model is drawn as if without materials.
class DrawnBody {
 public:
  DrawnBody(std::shared_ptr<const Model> model, std::span<const Material> materials,
            SkinMethod method, const DecodedImages& images = {});

  // Surfaces for a pose of the model's joints. Thread-safe.
  std::vector<render::Surface> at(std::span<const Transform> pose) const;

 private:
  struct Part {
    std::vector<std::uint32_t> vertices;                 // indices into the model; empty: all
    std::shared_ptr<const render::Triangles> triangles;  // of these
    SurfaceLook look;
    std::vector<render::Colour> colours;  // of the vertices, or one
  };
  Part part_of(const Model::Part& part) const;
  SharedCoordinates coordinates_of(const Part& part, int set) const;

  std::shared_ptr<const Model> model_;
  SkinBinding binding_;
  std::vector<Part> parts_;                             // none: all in the default body colour
  std::shared_ptr<const render::Triangles> triangles_;  // if there are no parts
};

}  // namespace krok::cli
