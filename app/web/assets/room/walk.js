// Walking through the room at a person's height: drag to look, arrows or W A S D to step.
import { Vector3 } from "/vendor/three.min.js";

const EYE_M = 1.6;
const STEP_M = 0.25;
const RAD_PER_PX = 0.004;
const STEEPEST_RAD = 1.4;
const STEPS = { ArrowUp: [1, 0], w: [1, 0], ArrowDown: [-1, 0], s: [-1, 0], ArrowLeft: [0, -1], a: [0, -1], ArrowRight: [0, 1], d: [0, 1] };

/** Steps by the names that buttons have. */
export const DIRECTIONS = { forward: [1, 0], back: [-1, 0], left: [0, -1], right: [0, 1] };

export class Walk {
  /** @param {{min: Vector3, max: Vector3}} box of the room; one starts in its middle */
  constructor(camera, canvas, box, onChange) {
    Object.assign(this, { camera, canvas, onChange, azimuth_rad: 0, rise_rad: 0 });
    camera.position.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, box.min.z + EYE_M);
    this.stop = new AbortController();
    const listen = (name, handle) => canvas.addEventListener(name, handle, { signal: this.stop.signal });
    listen("pointermove", (event) => event.buttons && this.look(event.movementX, event.movementY));
    listen("keydown", (event) => { if (STEPS[event.key]) { event.preventDefault(); this.step(STEPS[event.key]); } });
    this.turn();
  }

  look(right_px, down_px) {
    this.azimuth_rad += right_px * RAD_PER_PX;
    this.rise_rad = Math.min(STEEPEST_RAD, Math.max(-STEEPEST_RAD, this.rise_rad + down_px * RAD_PER_PX));
    this.turn();
  }

  /** One step: forward and to the right. */
  step([ahead, aside]) {
    const forward = this.forward().setZ(0).normalize();
    this.camera.position.addScaledVector(forward, STEP_M * ahead).addScaledVector(new Vector3(forward.y, -forward.x, 0), STEP_M * aside);
    this.turn();
  }

  /** Look at a place from where one stands. */
  face(place) {
    const to = place.clone().sub(this.camera.position);
    [this.azimuth_rad, this.rise_rad] = [Math.atan2(to.y, to.x), Math.atan2(to.z, Math.hypot(to.x, to.y))];
    this.turn();
  }

  forward() {
    const level = Math.cos(this.rise_rad);
    return new Vector3(level * Math.cos(this.azimuth_rad), level * Math.sin(this.azimuth_rad), Math.sin(this.rise_rad));
  }

  turn() {
    this.camera.lookAt(this.camera.position.clone().add(this.forward()));
    this.onChange();
  }

  dispose() {
    this.stop.abort();
  }
}
