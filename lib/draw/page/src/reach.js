// How far meshes reach beyond the joints that move them. To skin them takes long, so that one moment
// stands for all.

import { Vector3 } from 'three';

// Of two boxes at that moment; nothing where there is no mesh.
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
