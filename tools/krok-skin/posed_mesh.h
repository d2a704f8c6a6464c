#pragma once

#include <vector>

#include "skin/skin.h"
#include "tools/krok-skin/subject.h"

namespace krok::cli::skin {

// The subject's mesh at times of its motion: morph targets first, then skinning. Owns working
// memory: use one per thread. Subject and binding must outlive it.
class PosedMesh {
 public:
  PosedMesh(const Subject& subject, const SkinBinding& binding, int jobs);

  // `out` has one element per vertex; normals and tangents if the model has them, or empty.
  void at_frame(int frame, const SkinnedSurface& out);
  void at_time(double seconds, const SkinnedSurface& out);

 private:
  void skin(double frame, std::span<const Stretch> stretches, const SkinnedSurface& out);
  // The surface before skinning: the model's or, with morph targets, that of `frame`.
  SkinSurface shape_at(double frame, const SkinnedSurface& out);

  const Subject& subject_;
  const SkinBinding& binding_;
  SkinPose pose_;
  int jobs_;
  std::vector<Transform> joints_, scratch_;
  std::vector<Stretch> stretches_;
  std::vector<float> weights_;
  std::vector<Vec3f> positions_, normals_;
};

}  // namespace krok::cli::skin
