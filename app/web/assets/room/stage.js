// The room drawn with WebGL: a frame only when something changed, every kind of thing in one or two draw calls.
import { AmbientLight, Box3, DirectionalLight, Group, Quaternion, Scene, Vector3, WebGLRenderer } from "/vendor/three.min.js";
import { makeEllipsoids } from "./ellipsoids.js";
import { makeLabels } from "./labels.js";
import { makeAxes, makeFrusta, makeGrid, makeRays } from "./lines.js";
import { makeMarkers, SIGNS } from "./markers.js";
import { onColours, palette } from "./palette.js";
import { pickAt } from "./pick.js";
import { makePlates, SIDE_U } from "./plates.js";
import { makePoses } from "./poses.js";
import { cameraOf, orbit, shape, VIEWS } from "./views.js";
import { Walk } from "./walk.js";

const GREATEST_RATIO = 2; // device pixels drawn per CSS pixel
const CLICK_PX = 5; // a pointer that moved less was not dragging
const GRID_LINES = 40; // at the most, one way
const PART_OF_ROOM = { frustum: 0.035, pose: 0.02, axis: 0.08 }; // of the room's diagonal
const GREATEST_M = { frustum: 0.5, pose: 0.3 }; // in a hall
const LEAST_AXIS_M = 0.3;
const CLOSE_M = 2.5; // from where a picked thing is looked at
const PLATE_FRONT = new Vector3(0.25, 0.25, 1); // a plate is looked at from its front, a little from aside

/** Whether this browser draws in three dimensions at all. */
export const canDraw = () => Boolean(document.createElement("canvas").getContext("webgl2"));

export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas whose `data-draw-calls` tells how many calls the last frame took, `data-away` from how far it was seen
   * @param {(item: object | null) => void} onPick
   */
  constructor(canvas, onPick) {
    Object.assign(this, { canvas, layers: {}, pending: 0, items: [], picked: null, stop: new AbortController() });
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, GREATEST_RATIO));
    this.scene = new Scene();
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, -2, 3);
    this.scene.add(new AmbientLight(0xffffff, 1.6), sun);
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(canvas);
    this.stopColours = onColours(() => this.paint());
    this.listenToClicks(onPick);
  }

  listenToClicks(onPick) {
    let began = null;
    const listen = (name, handle) => this.canvas.addEventListener(name, handle, { signal: this.stop.signal });
    listen("pointerdown", (event) => { began = [event.clientX, event.clientY]; });
    listen("pointerup", (event) => {
      if (!began || Math.hypot(event.clientX - began[0], event.clientY - began[1]) > CLICK_PX) return;
      const box = this.canvas.getBoundingClientRect();
      onPick(pickAt(this, event.clientX - box.left, event.clientY - box.top));
    });
    listen("keydown", (event) => event.key === "Escape" && onPick(null));
  }

  /** Put one version of a map on the stage: targets, photographs, points. */
  show({ targets, photos, points, u_m, diagonal_m, bounds_m }) {
    this.box = new Box3(new Vector3(...bounds_m[0]), new Vector3(...bounds_m[1]));
    this.diagonal_m = diagonal_m;
    const plate_m = SIDE_U * u_m;
    const step_m = [1, 2, 5, 10, 20, 50, 100].find((step) => diagonal_m / step <= GRID_LINES) ?? diagonal_m / GRID_LINES;
    this.layer("grid", [makeGrid(this.box, step_m), makeAxes(Math.max(LEAST_AXIS_M, PART_OF_ROOM.axis * diagonal_m))]);
    this.layer("plates", [makePlates(targets, u_m)]);
    this.layer("codes", [makeLabels(targets, plate_m)]);
    this.layer("ellipsoids", [makeEllipsoids(targets)]);
    this.layer("photos", photos.length ? [makeFrusta(photos, Math.min(GREATEST_M.frustum, PART_OF_ROOM.frustum * diagonal_m))] : []);
    this.layer("points", points.length ? [makeMarkers(points.map((point) => ({ position_m: point.position_m, sign: SIGNS[point.role] })), this.renderer.getPixelRatio())] : []);
    this.items = [...targets, ...photos, ...points];
    this.resize();
  }

  showEllipsoids(axesOfTargets, scale) {
    this.layers.ellipsoids.children[0].userData.shape(axesOfTargets, scale);
    this.draw();
  }

  showPoses(poses) {
    this.poses = poses;
    this.layer("poses", makePoses(poses, Math.min(GREATEST_M.pose, PART_OF_ROOM.pose * this.diagonal_m)));
  }

  /** Show some layers and hide the others. */
  showLayers(visible) {
    for (const [name, shown] of Object.entries(visible)) if (this.layers[name]) this.layers[name].visible = shown;
    this.visible = visible;
    this.draw();
  }

  /** Mark what is picked, with lines to whatever saw it or is seen by it. */
  mark(item, others) {
    this.picked = item;
    const ring = item && makeMarkers([{ position_m: item.position_m, sign: SIGNS.ring }], this.renderer.getPixelRatio());
    this.layer("picked", item ? [ring, ...(others.length ? [makeRays(item.position_m, others.map((other) => other.position_m))] : [])] : []);
  }

  /** Look from a view; everything fits. */
  look(name) {
    this.controls?.dispose();
    this.view = name;
    const { clientWidth: width_px, clientHeight: height_px } = this.canvas;
    this.camera = cameraOf(name, this.box, width_px / height_px || 1);
    const middle = this.box.getCenter(new Vector3());
    this.controls = VIEWS[name].walks ? new Walk(this.camera, this.canvas, this.box, () => this.draw()) : orbit(this.camera, this.canvas, name, middle);
    this.controls.addEventListener?.("change", () => this.draw());
    this.canvas.dataset.view = name;
    this.resize();
  }

  /** Bring a thing into the middle of the picture. */
  face(item) {
    const place = new Vector3(...item.position_m);
    if (this.controls.face) { this.controls.face(place); return; }
    const way = this.camera.position.clone().sub(this.controls.target);
    if (this.camera.isPerspectiveCamera) {
      if (item.kind === "target") way.copy(PLATE_FRONT).applyQuaternion(new Quaternion(...item.orientation_xyzw));
      way.setLength(CLOSE_M);
    }
    this.camera.position.copy(place).add(way);
    this.controls.target.copy(place);
    this.controls.update();
    this.draw();
  }

  layer(name, meshes) {
    const before = this.layers[name];
    before?.traverse((mesh) => { mesh.geometry?.dispose(); mesh.material?.dispose(); mesh.dispose?.(); });
    if (before) this.scene.remove(before);
    const group = new Group();
    for (const mesh of meshes) group.add(mesh);
    group.visible = this.visible?.[name] ?? true;
    this.layers[name] = group;
    this.scene.add(group);
    this.paint();
  }

  paint() {
    const colours = palette();
    this.renderer.setClearColor(colours.ground);
    this.scene.traverse((mesh) => mesh.userData.paint?.(colours));
    this.draw();
  }

  resize() {
    const { clientWidth: width_px, clientHeight: height_px } = this.canvas;
    if (!this.camera || !width_px || !height_px) return;
    this.renderer.setSize(width_px, height_px, false);
    shape(this.camera, width_px / height_px, this.diagonal_m);
    this.scene.traverse((mesh) => mesh.userData.resize?.(width_px, height_px));
    this.draw();
  }

  /** Ask for a frame. */
  draw() {
    if (this.pending || !this.camera) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.camera.updateMatrixWorld();
      this.layers.codes?.children[0]?.userData.arrange(this.camera, this.picked);
      this.renderer.render(this.scene, this.camera);
      this.canvas.dataset.drawCalls = this.renderer.info.render.calls;
      this.canvas.dataset.away = this.controls.getDistance?.() ?? ""; // metres from what the camera turns about
      this.canvas.dataset.instances = this.items.length + (this.poses?.length ?? 0);
    });
  }

  dispose() {
    cancelAnimationFrame(this.pending);
    for (const name of Object.keys(this.layers)) this.layer(name, []);
    cancelAnimationFrame(this.pending);
    this.stop.abort();
    this.sizes.disconnect();
    this.stopColours();
    this.controls?.dispose();
    this.renderer.dispose();
  }
}
