#include "skin/mesh_error.h"

#include <cassert>

#include "core/index.h"
#include "core/parallel.h"
#include "skin/skin.h"

namespace krok {

MeshError mesh_error(const MovedModel& a, const MovedModel& b, int moments, int jobs) {
  const std::size_t vertices = a.model.positions.size();
  assert(b.model.positions.size() == vertices);
  const SkinBinding bindings[2] = {{a.model, SkinMethod::linear}, {b.model, SkinMethod::linear}};
  std::vector<MeshError> errors(at(moments));
  constexpr std::size_t kAtOnce = 8;
  parallel_for(errors.size(), kAtOnce, jobs, [&](std::size_t begin, std::size_t end) {
    SkinPose poses[2] = {SkinPose(bindings[0]), SkinPose(bindings[1])};
    std::vector<SkinMatrix> palettes[2] = {std::vector<SkinMatrix>(a.model.skeleton.names.size()),
                                           std::vector<SkinMatrix>(b.model.skeleton.names.size())};
    std::vector<Vec3f> positions[2] = {std::vector<Vec3f>(vertices), std::vector<Vec3f>(vertices)};
    std::vector<Vec3f> shapes[2] = {std::vector<Vec3f>(a.shape ? vertices : 0),
                                    std::vector<Vec3f>(b.shape ? vertices : 0)};
    for (std::size_t moment = begin; moment < end; ++moment) {
      a.palette(static_cast<int>(moment), palettes[0]);
      b.palette(static_cast<int>(moment), palettes[1]);
      for (int k = 0; k < 2; ++k) {
        poses[k].set_palette(palettes[k]);
        const MovedModel& moved = k == 0 ? a : b;
        std::span<const Vec3f> shape = moved.model.positions;
        if (moved.shape) {
          moved.shape(static_cast<int>(moment), shapes[k]);
          shape = shapes[k];
        }
        skin(bindings[k], poses[k], {shape, {}, {}}, {positions[k], {}, {}});
      }
      MeshError& worst = errors[moment];
      worst.moment = static_cast<int>(moment);
      for (std::size_t v = 0; v < vertices; ++v) {
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
