// How far meshes extend beyond the joints that move them. Skinning all frames would be slow, so one
// frame is used as an estimate for all.

import { Vector3 } from 'three';

// Takes the boxes of joints and meshes in that frame; zero if there is no mesh.
export function reachBeyond(joints, meshes) {
  const none = new Vector3();
  if (meshes.isEmpty()) return { min: none, max: none };
  return {
    min: joints.min.clone().sub(meshes.min).max(none),
    max: meshes.max.clone().sub(joints.max).max(none),
  };
}

export function widen(box, reach) {
  box.min.sub(reach.min);
  box.max.add(reach.max);
  return box;
}
