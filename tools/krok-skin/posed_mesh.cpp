#include "tools/krok-skin/posed_mesh.h"

#include <algorithm>
#include <cmath>

#include "motion/sample.h"
#include "skin/morph.h"

namespace krok::cli::skin {

PosedMesh::PosedMesh(const Subject& subject, const SkinBinding& binding, int jobs)
    : subject_(subject),
      binding_(binding),
      pose_(binding),
      jobs_(jobs),
      joints_(subject.clip.skeleton.names.size()),
      scratch_(3 * joints_.size()) {}

void PosedMesh::at_frame(int frame, const SkinnedSurface& out) {
  subject_.clip.get_pose(frame, joints_);
  std::span<const Stretch> stretches = subject_.stretches;
  if (!stretches.empty()) {
    stretches = stretches.subspan(static_cast<std::size_t>(frame) * joints_.size(), joints_.size());
  }
  skin(frame, stretches, out);
}

void PosedMesh::at_time(double seconds, const SkinnedSurface& out) {
  sample(subject_.clip, seconds, joints_, scratch_);
  const double frame = seconds * subject_.clip.rate;
  if (!subject_.stretches.empty()) {
    stretches_.resize(joints_.size());
    sample(subject_.stretches, frame, stretches_);
  }
  skin(frame, stretches_, out);
}

void PosedMesh::skin(double frame, std::span<const Stretch> stretches, const SkinnedSurface& out) {
  pose_.set(joints_, stretches);
  krok::skin(binding_, pose_, shape_at(frame, out), out, jobs_);
}

SkinSurface PosedMesh::shape_at(double frame, const SkinnedSurface& out) {
  SkinSurface surface = skin_surface(subject_.model);
  if (out.normals.empty()) surface.normals = {};
  if (out.tangents.empty()) surface.tangents = {};
  if (!subject_.changes_shape()) return surface;
  weights_at(subject_.weights, frame / subject_.weights.rate, weights_);
  positions_.resize(surface.positions.size());
  normals_.resize(surface.normals.size());
  apply_morphs(subject_.morphs, weights_, {surface.positions, surface.normals},
               {positions_, normals_}, jobs_);
  surface.positions = positions_;
  surface.normals = normals_;
  return surface;
}

}  // namespace krok::cli::skin
