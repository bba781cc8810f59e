// What is drawn with lines, one draw call each: frusta of photographs, rays of what is picked, the floor's grid, the axes.
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Quaternion, Vector3 } from "/vendor/three.min.js";

const FRUSTUM_EDGES = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1], [1, 5], [5, 2]]; // apex, four corners, the sign for up

/** Line segments between pairs of points; `colour` names what of the palette they take. */
export function makeLines(pairs_m, colour, { opacity = 1 } = {}) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(pairs_m.flat(2)), 3));
  const material = new LineBasicMaterial({ transparent: opacity < 1, opacity });
  const lines = new LineSegments(geometry, material);
  lines.userData.paint = (colours) => material.color.copy(colours[colour]);
  return lines;
}

/**
 * Pyramids from the projection centres through the pictures' corners.
 * @param {Array<{position_m: number[], orientation_xyzw: number[], camera: {width_px: number, height_px: number, fx: number, fy: number, cx: number, cy: number}}>} photos
 * @param {number} depth_m height of a pyramid
 */
export const makeFrusta = (photos, depth_m) => makeLines(photos.filter((photo) => photo.camera).flatMap((photo) => frustum(photo, depth_m)), "photo", { opacity: 0.8 });

function frustum({ position_m, orientation_xyzw, camera }, depth_m) {
  const turn = new Quaternion(...orientation_xyzw);
  const right = camera.width_px - 0.5; // pixel 0 is the centre of the first one
  const bottom = camera.height_px - 0.5;
  const seen_px = [[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom], [right / 2, -0.5 - 0.18 * camera.height_px]];
  const rays = seen_px.map(([x, y]) => new Vector3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1));
  const corners = [position_m, ...rays.map((ray) => ray.multiplyScalar(depth_m).applyQuaternion(turn).add(new Vector3(...position_m)).toArray())];
  return FRUSTUM_EDGES.map(([from, to]) => [corners[from], corners[to]]);
}

/** Lines from one place to others: a target and the photographs that saw it, or the other way round. */
export const makeRays = (from_m, ends_m) => makeLines(ends_m.map((end_m) => [from_m, end_m]), "accent", { opacity: 0.55 });

/** A grid on the floor, a line per step. */
export function makeGrid({ min, max }, step_m) {
  const [x0, y0] = [min.x, min.y].map((value) => step_m * (Math.floor(value / step_m) - 1));
  const [x1, y1] = [max.x, max.y].map((value) => step_m * (Math.ceil(value / step_m) + 1));
  const along = (from, to) => Array.from({ length: Math.round((to - from) / step_m) + 1 }, (_, index) => from + index * step_m);
  const z = min.z;
  const lines = makeLines([...along(x0, x1).map((x) => [[x, y0, z], [x, y1, z]]), ...along(y0, y1).map((y) => [[x0, y, z], [x1, y, z]])], "line");
  lines.material.depthWrite = false; // the axes lie in it
  lines.renderOrder = -1;
  return lines;
}

const AXIS_COLOURS = [[0.75, 0.1, 0.12], [0.05, 0.5, 0.2], [0.1, 0.35, 0.8]]; // x, y, z, as everywhere

/** The site's axes from its origin. */
export function makeAxes(length_m) {
  const ends_m = [[length_m, 0, 0], [0, length_m, 0], [0, 0, length_m]];
  const lines = makeLines(ends_m.map((end_m) => [[0, 0, 0], end_m]), "ink");
  lines.geometry.setAttribute("color", new BufferAttribute(new Float32Array(AXIS_COLOURS.flatMap((colour) => [...colour, ...colour])), 3));
  lines.material.vertexColors = true;
  lines.userData.paint = () => {};
  return lines;
}
