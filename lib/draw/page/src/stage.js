// The scene: light, ground, camera, rendering.

import {
  AmbientLight,
  Color,
  DirectionalLight,
  Fog,
  HemisphereLight,
  PCFShadowMap,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Ground } from './ground.js';
import { Terrain } from './terrain.js';

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    // Asking for errors would wait for one program after the other.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio ?? 1, 2));

    this.scene = new Scene();
    this.scene.add(new HemisphereLight(0xffffff, 0x8d8d8d, 1.4), new AmbientLight(0xffffff, 0.3));
    this.sun = new DirectionalLight(0xffffff, 2.2);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.bias = -0.0005;
    this.sun.shadow.normalBias = 0.02;
    this.scene.add(this.sun, this.sun.target);

    this.camera = new PerspectiveCamera(40, 1, 0.01, 1000);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => {
      this.stayAbove();
      this.redraw();
    });
    this.flown = null; // the recorded camera in use, or null
    this.floor = 0; // metres; lower where a character is

    this.ground = new Ground();
    this.scene.add(this.ground);
    this.dark = globalThis.matchMedia?.('(prefers-color-scheme: dark)');
    this.dark?.addEventListener('change', () => this.applyColours());
    this.applyColours();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  applyColours() {
    const dark = Boolean(this.dark?.matches);
    const air = new Color(dark ? '#15181c' : '#f4f5f7');
    this.scene.background = air;
    this.scene.fog = new Fog(air, 20, 90);
    this.ground.ink.setRGB(...(dark ? [190, 205, 220] : [60, 72, 86]).map((part) => part / 255));
    this.terrain?.material.color.set(dark ? '#4a5158' : '#cfd2c8');
    this.themed?.();
    this.redraw();
  }

  // Shows a ground in place of the level grid.
  setTerrain(item, bytes) {
    const { ink } = this.ground;
    this.scene.remove(this.ground);
    this.ground = this.terrain = new Terrain(item, bytes, ink);
    this.ground.ink = ink;
    this.scene.add(this.ground);
    this.applyColours();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    // The observer calls at first with the size that it has already.
    if (width === 0 || height === 0 || (width === this.width && height === this.height)) return;
    Object.assign(this, { width, height });
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.redraw();
    // Its new size has emptied the canvas, which would be seen until the next frame.
    if (this.drawn) this.draw();
  }

  redraw() {
    this.stale = true;
  }

  // Frames `box` from the direction `from`: by default from the front, slightly from the character's
  // left and from above.
  frame(box, from = new Vector3(0.55, 0.28, 1)) {
    const centre = box.getCenter(new Vector3());
    const size = box.getSize(new Vector3());
    const direction = from.clone().normalize();
    const distance = Math.max(fitDistance(box, centre, direction, this.camera), 0.05);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, distance);
    this.reachTo(distance);
    this.controls.update();
    this.aimSun(centre, Math.max(size.x, size.y, size.z));
    this.redraw();
  }

  // Looks at the same point from another side.
  lookFrom(direction) {
    const { distance, controls: { target } } = this;
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.update();
    this.redraw();
  }

  get distance() {
    return this.camera.position.distanceTo(this.controls.target);
  }

  // Sets what depths are drawn, for a camera at a distance from its target.
  reachTo(distance) {
    this.camera.near = distance / 200;
    this.camera.far = Math.max(distance * 60, 200);
    this.scene.fog.near = Math.max(20, distance * 3);
    this.scene.fog.far = Math.max(90, distance * 14);
    this.camera.updateProjectionMatrix();
  }

  floorAt(x, z) {
    if (!this.terrain) return Math.min(this.floor, 0);
    const from = new Vector3(x, 1e4, z);
    const [hit] = new Raycaster(from, new Vector3(0, -1, 0)).intersectObject(this.terrain);
    return hit ? hit.point.y : -Infinity;
  }

  // The camera is never under the floor.
  stayAbove() {
    if (this.flown) return;
    const { position } = this.camera;
    const lowest = this.floorAt(position.x, position.z) + Math.min(0.05, this.distance * 0.05);
    if (position.y >= lowest) return;
    position.y = lowest;
    this.camera.lookAt(this.controls.target);
  }

  aimSun(centre, extent) {
    const reach = Math.max(extent, 1) * 0.9;
    this.sun.target.position.copy(centre);
    this.sun.position.copy(centre).add(new Vector3(0.5, 1.4, 0.7).multiplyScalar(reach * 2));
    Object.assign(this.sun.shadow.camera, {
      left: -reach, right: reach, top: reach, bottom: -reach, near: 0.01, far: reach * 6,
    });
    this.sun.shadow.camera.updateProjectionMatrix();
  }

  // Moves camera and light with characters whose bounds were `before` and are `now`, and the camera
  // as much farther as that needs.
  follow(before, now) {
    const { target } = this.controls;
    const [from, to] = [before, now].map((box) => box.getCenter(new Vector3()));
    const direction = this.camera.position.clone().sub(target).normalize();
    const growth = fitDistance(now, to, direction, this.camera) / fitDistance(before, from, direction, this.camera);
    const step = to.sub(from);
    target.add(step);
    this.camera.position.add(step);
    if (Math.abs(growth - 1) > 1e-9) {
      this.camera.position.sub(target).multiplyScalar(growth).add(target);
      this.reachTo(this.distance);
      for (const side of ['left', 'right', 'top', 'bottom', 'far']) this.sun.shadow.camera[side] *= growth;
      this.sun.shadow.camera.updateProjectionMatrix();
    }
    this.sun.position.add(step);
    this.sun.target.position.add(step);
    this.controls.update();
    this.redraw();
  }

  // Switches to a recorded camera, or with null back to the free camera.
  fly(track) {
    this.flown = track;
    this.controls.enabled = !track;
    if (!track && this.own) {
      this.camera.position.copy(this.own.position);
      this.camera.fov = this.own.fov;
      this.camera.updateProjectionMatrix();
      this.controls.update();
      this.own = null;
    } else if (track && !this.own) {
      this.own = { position: this.camera.position.clone(), fov: this.camera.fov };
    }
    this.redraw();
  }

  draw() {
    if (this.flown) {
      this.camera.position.copy(this.flown.position);
      this.camera.quaternion.copy(this.flown.orientation);
      this.camera.fov = (this.flown.fieldOfView * 180) / Math.PI;
      this.camera.updateProjectionMatrix();
    }
    if (!this.stale) return false;
    this.stale = false;
    this.drawn = true;
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  // Projects a world point to the canvas, in CSS pixels; null behind the camera.
  project(point) {
    const seen = point.clone().project(this.camera);
    if (seen.z > 1) return null;
    return {
      x: ((seen.x + 1) / 2) * this.canvas.clientWidth,
      y: ((1 - seen.y) / 2) * this.canvas.clientHeight,
    };
  }
}

const MARGIN = 1.06; // of the picture around what is framed

// How far from `centre` a camera in `direction` has all corners of `box` in its picture.
export function fitDistance(box, centre, direction, camera) {
  const right = new Vector3().crossVectors(camera.up, direction);
  if (right.lengthSq() < 1e-9) right.set(1, 0, 0);
  right.normalize();
  const up = new Vector3().crossVectors(direction, right);
  const high = Math.tan((camera.fov * Math.PI) / 360) / MARGIN;
  const wide = high * camera.aspect;
  let distance = 0;
  const corner = new Vector3();
  for (let i = 0; i < 8; ++i) {
    corner.set(
      i & 1 ? box.max.x : box.min.x,
      i & 2 ? box.max.y : box.min.y,
      i & 4 ? box.max.z : box.min.z,
    ).sub(centre);
    const apart = Math.max(Math.abs(corner.dot(right)) / wide, Math.abs(corner.dot(up)) / high);
    distance = Math.max(distance, corner.dot(direction) + apart);
  }
  return distance;
}
