// How the room is looked at: from around, as a plan, isometric as in a paper's figure, or from within.
import { OrbitControls, OrthographicCamera, PerspectiveCamera, Vector3 } from "/vendor/three.min.js";

/** Views by name: from where, with lines of sight that meet or not, and whether the view turns. */
export const VIEWS = {
  room: { label: "Room", from: [-0.75, -1, 0.7], meeting: true, turns: true },
  plan: { label: "Plan", from: [0, -1e-4, 1], meeting: false, turns: false },
  isometric: { label: "Isometric", from: [-1, -1, Math.SQRT2 * Math.tan(Math.PI / 6)], meeting: false, turns: true },
  walk: { label: "Walk", meeting: true, walks: true },
};
const FIELD_DEG = 50;
const WALK_FIELD_DEG = 68;
const MARGIN = 1.12; // around what is fitted
const [ROTATE, PAN, TOUCH_PAN, TOUCH_ROTATE, DOLLY_PAN, DOLLY_ROTATE] = [0, 2, 1, 0, 2, 3]; // three's numbers of gestures

/** A camera of a view, set to show a box. */
export function cameraOf(name, box, aspect) {
  const view = VIEWS[name];
  const camera = view.meeting ? new PerspectiveCamera(view.walks ? WALK_FIELD_DEG : FIELD_DEG) : new OrthographicCamera();
  camera.up.set(0, 0, 1);
  if (!view.walks) fit(camera, new Vector3(...view.from).normalize(), box, aspect);
  return camera;
}

/** Stand where the whole box is seen, looking at its middle. */
function fit(camera, from, box, aspect) {
  const middle = box.getCenter(new Vector3());
  const reach_m = box.getSize(new Vector3()).length();
  camera.position.copy(middle).addScaledVector(from, 2 * reach_m);
  camera.lookAt(middle);
  camera.updateMatrixWorld();
  const corners = Array.from({ length: 8 }, (_, corner) => new Vector3(...["x", "y", "z"].map((axis, bit) => (corner & (1 << bit) ? box.max[axis] : box.min[axis]))));
  const seen = corners.map((corner) => camera.worldToLocal(corner));
  const half = ({ x, y }) => MARGIN * Math.max(Math.abs(y), Math.abs(x) / aspect);
  camera.userData.half_m = Math.max(...seen.map(half));
  if (!camera.isPerspectiveCamera) return;
  const slope = Math.tan((FIELD_DEG * Math.PI) / 360);
  const away_m = Math.max(...seen.map((at) => half(at) / slope + at.z + 2 * reach_m)); // at.z counts from where the camera stands now
  camera.position.copy(middle).addScaledVector(from, away_m);
}

/** Give a camera the shape of its picture. */
export function shape(camera, aspect, reach_m) {
  camera.near = camera.isPerspectiveCamera ? 0.02 : -4 * reach_m;
  camera.far = 8 * reach_m + 10;
  if (camera.isPerspectiveCamera) camera.aspect = aspect;
  else Object.assign(camera, { left: -camera.userData.half_m * aspect, right: camera.userData.half_m * aspect, top: camera.userData.half_m, bottom: -camera.userData.half_m });
  camera.updateProjectionMatrix();
}

/** Gestures of a view about a point; arrow keys move it. */
export function orbit(camera, canvas, name, target) {
  const controls = new OrbitControls(camera, canvas);
  const { turns } = VIEWS[name];
  controls.enableRotate = turns;
  controls.mouseButtons = { LEFT: turns ? ROTATE : PAN, MIDDLE: 1, RIGHT: PAN };
  controls.touches = { ONE: turns ? TOUCH_ROTATE : TOUCH_PAN, TWO: turns ? DOLLY_ROTATE : DOLLY_PAN };
  controls.zoomToCursor = true;
  controls.target.copy(target);
  controls.listenToKeyEvents(canvas);
  controls.update();
  return controls;
}
