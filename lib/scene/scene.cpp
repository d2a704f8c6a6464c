#include "scene/scene.h"

namespace krok {

Skeleton skeleton_of(const Scene& scene) {
  SceneState still;
  still.joints_alone = true;
  scene.evaluate(-1, 0, still);
  Skeleton skeleton;
  for (std::size_t j = 0; j < scene.joint_names.size(); ++j) {
    skeleton.add(scene.joint_names[j], scene.joint_parents[j], still.joints[j],
                 j < scene.joint_ends.size() && scene.joint_ends[j] != 0);
  }
  return skeleton;
}

}  // namespace krok
