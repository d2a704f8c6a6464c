#include "skin/mesh_error.h"

#include <cassert>
#include <memory>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "skin/skin.h"

namespace krok {

ShownMesh shown(const MovedModel& moved) {
  const auto binding = std::make_shared<const SkinBinding>(moved.model, SkinMethod::linear);
  return [moved, binding] {
    return [moved, binding, pose = std::make_shared<SkinPose>(*binding),
            palette = std::vector<SkinMatrix>(moved.model.skeleton.names.size()),
            shape = std::vector<Vec3f>(moved.shape ? moved.model.positions.size() : 0)](
               int moment, std::span<Vec3f> positions) mutable {
      moved.palette(moment, palette);
      pose->set_palette(palette);
      if (moved.shape) moved.shape(moment, shape);
      skin(*binding, *pose,
           {moved.shape ? std::span<const Vec3f>(shape) : moved.model.positions, {}, {}},
           {positions, {}, {}});
    };
  };
}

MeshError mesh_error(const MovedModel& a, const MovedModel& b, int moments, int jobs) {
  assert(b.model.positions.size() == a.model.positions.size());
  return mesh_error(shown(a), shown(b), a.model.vertex_count(), moments, jobs);
}

MeshError mesh_error(const ShownMesh& a, const ShownMesh& b, int vertices, int moments, int jobs) {
  std::vector<MeshError> errors(at(moments));
  constexpr std::size_t kAtOnce = 8;
  parallel_for(errors.size(), kAtOnce, jobs, [&](std::size_t begin, std::size_t end) {
    const ShapeAtMoment shapes[2] = {a(), b()};
    std::vector<Vec3f> positions[2] = {std::vector<Vec3f>(at(vertices)),
                                       std::vector<Vec3f>(at(vertices))};
    for (std::size_t moment = begin; moment < end; ++moment) {
      for (int k = 0; k < 2; ++k) shapes[k](static_cast<int>(moment), positions[k]);
      MeshError& worst = errors[moment];
      worst.moment = static_cast<int>(moment);
      for (std::size_t v = 0; v < at(vertices); ++v) {
        const double off = static_cast<double>((positions[0][v] - positions[1][v]).norm());
        if (!(off > worst.largest)) continue;
        worst.largest = off;
        worst.vertex = static_cast<int>(v);
      }
    }
  });
  MeshError worst;
  for (const MeshError& error : errors) {
    if (error.largest > worst.largest) worst = error;
  }
  return worst;
}

}  // namespace krok
