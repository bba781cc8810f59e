// What stands under a finger: the plate that a ray meets, otherwise the nearest thing on the screen.
import { Raycaster, Vector2, Vector3 } from "/vendor/three.min.js";

const NEAR_PX = 14; // a fingertip's uncertainty
const ON_PX = 5; // a thing this close is meant although a plate hangs behind it
const LAYER_OF_KIND = { target: "plates", photo: "photos", point: "points", pose: "poses" };

/**
 * The item at a place of the picture, or null.
 * @param {import("./stage.js").Stage} stage
 * @param {number} x_px from the canvas's left
 * @param {number} y_px from its top
 */
export function pickAt(stage, x_px, y_px) {
  stage.camera.updateMatrixWorld(); // it may have moved since the last frame
  const plate = plateAt(stage, x_px, y_px);
  const near = nearest(stage, x_px, y_px, plate ? ON_PX : NEAR_PX);
  if (!plate) return near;
  return near && depth(stage, near) < depth(stage, plate) ? near : plate;
}

function plateAt({ canvas, camera, layers, items }, x_px, y_px) {
  const caster = new Raycaster();
  caster.setFromCamera(new Vector2((2 * x_px) / canvas.clientWidth - 1, 1 - (2 * y_px) / canvas.clientHeight), camera);
  const [hit] = layers.plates.visible ? caster.intersectObject(layers.plates.children[0]) : [];
  return hit ? items[hit.instanceId] : null; // the plates come first among the items
}

function nearest({ canvas, camera, layers, items, poses = [] }, x_px, y_px, within_px) {
  let [found, best_px] = [null, within_px];
  const at = new Vector3();
  for (const item of [...items, ...poses]) {
    if (!layers[LAYER_OF_KIND[item.kind]]?.visible) continue;
    at.set(...item.position_m).project(camera);
    if (at.z < -1 || at.z > 1) continue;
    const away_px = Math.hypot(((at.x + 1) / 2) * canvas.clientWidth - x_px, ((1 - at.y) / 2) * canvas.clientHeight - y_px);
    if (away_px < best_px) [found, best_px] = [item, away_px];
  }
  return found;
}

const depth = ({ camera }, item) => new Vector3(...item.position_m).project(camera).z;
