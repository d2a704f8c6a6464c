#pragma once

#include <optional>
#include <span>
#include <vector>

#include "render/camera.h"
#include "render/image.h"
#include "render/tracer_internal.h"

// Renders actors to pixels.

namespace krok::render {

// Some actors seen by one camera.
struct View {
  struct Layer {
    const TracedActor* actor = nullptr;
    float opacity = 1;    // of the whole silhouette
    bool behind = false;  // drawn behind the others regardless of depth
  };
  Camera camera;
  std::optional<Lens> lens = {};                 // replaces the camera; its image fills the height
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom exclusive
  std::vector<Layer> layers;
  bool shadows = false;  // on the ground y = 0; requires a camera above it
};

// Projects world points to pixels, by the camera or the lens of a view.
class Projection {
 public:
  explicit Projection(const View& view);

  // The line of sight through an image position, with steps to its neighbours of a pixel divided by
  // `parts`. For a lens these are the steps at `depth` metres from the eye.
  Sight sight(const Vec2& place, int parts, double depth) const;
  // Empty for a point that is not in front of a lens.
  std::optional<Vec2> project(const Vec3& point) const;

  const Vec3& right() const { return right_; }
  const Vec3& up() const { return up_; }
  const Vec3& towards() const { return towards_; }  // of the image's middle
  // The depth scale's origin: the target of a camera, the eye of a lens.
  const Vec3& origin() const { return origin_; }

 private:
  Camera camera_;
  std::optional<Lens> lens_;
  Vec2 middle_ = Vec2::Zero();  // pixels, of a lens
  double focal_ = 1;            // pixels, of a lens
  Vec3 right_, up_, towards_, origin_;
};

// Renders the views over the image's content on `jobs` threads (see parallel_for); the pixels do
// not depend on the number of threads. Views must lie inside the image and not overlap.
void render(std::span<const View> views, Image& image, int jobs);

}  // namespace krok::render
