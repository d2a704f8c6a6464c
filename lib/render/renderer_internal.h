#pragma once

#include <span>
#include <vector>

#include "render/camera.h"
#include "render/image.h"
#include "render/tracer_internal.h"

// From figures to pixels.

namespace krok::render {

// One look at some figures.
struct View {
  struct Layer {
    const TracedActor* actor = nullptr;
    float opacity = 1;    // of its whole silhouette
    bool behind = false;  // behind the others wherever it is
  };
  Camera camera;
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom beyond the last
  std::vector<Layer> layers;
  bool shadows = false;  // on the ground y = 0; wants the camera above it
};

// Paints the views over what the image shows, on `jobs` threads (as in parallel_for); the pixels do
// not depend on their number. Views lie inside the image and do not overlap.
void render(std::span<const View> views, Image& image, int jobs);

}  // namespace krok::render
