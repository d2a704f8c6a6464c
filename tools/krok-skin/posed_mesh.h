#pragma once

#include <vector>

#include "skin/skin.h"
#include "tools/krok-skin/subject.h"

namespace krok::skinning {

// The subject's mesh at moments of its motion: its shape first, then the skeleton. Owns the working
// memory, so that each thread needs one of its own; subject and binding must outlive it.
class PosedMesh {
 public:
  PosedMesh(const Subject& subject, const SkinBinding& binding, int jobs);

  // `out` has a place for each vertex, of normals and tangents where the model has them or none.
  void at_frame(int frame, const SkinnedSurface& out);
  void at_time(double seconds, const SkinnedSurface& out);

 private:
  void skin(double frame, const SkinnedSurface& out);
  // What the skeleton moves: the model's own surface or, where its shape changes, that of `frame`.
  SkinSurface shape_at(double frame, const SkinnedSurface& out);

  const Subject& subject_;
  const SkinBinding& binding_;
  SkinPose pose_;
  int jobs_;
  std::vector<Transform> joints_, scratch_;
  std::vector<float> weights_;
  std::vector<Vec3f> positions_, normals_;
};

}  // namespace krok::skinning
