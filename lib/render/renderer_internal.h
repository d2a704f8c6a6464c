#pragma once

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
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom exclusive
  std::vector<Layer> layers;
  bool shadows = false;  // on the ground y = 0; requires a camera above it
};

// Renders the views over the image's content on `jobs` threads (see parallel_for); the pixels do
// not depend on the number of threads. Views must lie inside the image and not overlap.
void render(std::span<const View> views, Image& image, int jobs);

}  // namespace krok::render
