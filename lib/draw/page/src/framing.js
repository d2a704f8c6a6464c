// What the camera frames: all characters, a selected one or a joint; views from front, side and top.

import { Box3, Vector3 } from 'three';

// A whole motion that is framed from farther than this is followed instead, or it would be a speck.
const FAR = 1.25;
const FAR_ON_GROUND = 1.8; // where the way itself is looked at
const JOINT_REACH = 0.08; // around a selected joint, of the character's size

export const VIEWS = {
  front: new Vector3(0, 0, 1),
  side: new Vector3(1, 0, 0),
  top: new Vector3(0, 1, 1e-4),
};

export class Framing {
  constructor(player, stage, setFollow) {
    this.player = player;
    this.stage = stage;
    this.setFollow = setFollow;
  }

  // All that is shown: over the whole motion, or where it moves far, now and following.
  all(from = this.from()) {
    this.player.framed = null;
    this.frame(this.player.actors(), from);
  }

  // The selected joint, or else its character; without any, as all().
  selected() {
    const { player, stage } = this;
    const { selected } = player;
    if (!selected || !player.actors().includes(selected.made)) {
      this.all(this.direction());
      return;
    }
    const { made, joint } = selected;
    player.framed = made;
    const place = made.actor.jointPosition(joint).clone().add(made.actor.group.position);
    const reach = made.actor.size * JOINT_REACH;
    stage.frame(new Box3(place, place.clone()).expandByScalar(reach), this.direction());
    this.follow(true);
  }

  frame(actors, from) {
    const { player, stage } = this;
    if (actors.length === 0) return;
    const whole = new Box3();
    for (const { actor } of actors) {
      whole.union(actor.extents.whole.clone().translate(actor.group.position));
    }
    const now = player.bounds();
    for (const { actor } of actors) actor.update(player.time);
    stage.frame(whole, from);
    const far = stage.distance;
    stage.frame(now, from);
    const near = stage.distance;
    if (far > (stage.terrain ? FAR_ON_GROUND : FAR) * near) {
      this.follow(true);
    } else {
      stage.frame(whole, from);
      player.before = null;
    }
  }

  follow(on) {
    this.player.before = null;
    if (on && !this.player.shown.follow) this.setFollow(true);
    this.player.followActors();
  }

  view(name) {
    this.stage.lookFrom(VIEWS[name]);
  }

  // From where the camera looks now.
  direction() {
    return this.stage.camera.position.clone().sub(this.stage.controls.target);
  }

  // On a ground: from above, from the side of the way, and from its lower end, where steps are seen.
  from() {
    const [first] = this.player.actors();
    if (!this.stage.terrain || !first) return undefined;
    const { actor } = first;
    const way = actor.rootAt(actor.duration).sub(actor.rootAt(0));
    const climbs = way.y;
    way.setY(0);
    if (way.length() < 0.5) return undefined;
    way.normalize();
    const from = new Vector3(way.z, 0.75, -way.x);
    return from.addScaledVector(way, climbs > 0.1 ? -0.6 : 0.6);
  }
}
