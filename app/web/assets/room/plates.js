// All targets in one draw call: a shader paints each plate's sixteen dots from its code, sharp at every distance.
import { DoubleSide, InstancedBufferAttribute, InstancedMesh, Matrix4, PlaneGeometry, Quaternion, ShaderMaterial, Vector3 } from "/vendor/three.min.js";
import { asShown } from "./palette.js";

export const SIDE_U = 13; // a plate's side in modules u
const CELLS = 16;
const BASE_CELLS = [0, 3, 5, 12, 15]; // red dots A, B, E, D, C, row by row
const RED = 3; // beside the digits' 0 black, 1 green, 2 white

const SMALLEST_PX = 8; // of a plate seen from the front

const VERTEX = `
#define SMALLEST_PX ${SMALLEST_PX}.0
attribute vec2 aCells;
flat varying vec2 vCells;
varying vec2 vUv;
uniform float uHeight_px;
void main() {
  vCells = aCells;
  vUv = uv;
  mat4 placed = projectionMatrix * modelViewMatrix * instanceMatrix;
  float plate_px = 0.5 * length(instanceMatrix[0].xyz) * projectionMatrix[1][1] / placed[3].w * uHeight_px;
  float enlarged = max(1.0, SMALLEST_PX / plate_px); // far plates stay visible
  gl_Position = placed * vec4(position.xy * enlarged, position.z, 1.0);
}`;

// Inks are the print colours, sRGB. A plate from behind is a blank in the page's line colour.
const FRAGMENT = `
flat varying vec2 vCells;
varying vec2 vUv;
uniform vec3 uEdge;
uniform vec3 uBack;
const vec3 BLACK = vec3(24.0, 24.0, 26.0) / 255.0;
const vec3 GREEN = vec3(10.0, 150.0, 62.0) / 255.0;
const vec3 WHITE = vec3(238.0, 238.0, 232.0) / 255.0;
const vec3 RED = vec3(200.0, 28.0, 36.0) / 255.0;
void main() {
  vec2 at = vec2(vUv.x, 1.0 - vUv.y) * 13.0;
  float soft = max(fwidth(at.x), fwidth(at.y));
  vec2 cell = clamp(floor((at - 0.5) / 3.0), 0.0, 3.0);
  float index = cell.y * 4.0 + cell.x;
  float packed = index < 8.0 ? vCells.x : vCells.y;
  float ink = mod(floor(packed / exp2(2.0 * mod(index, 8.0)) + 1e-4), 4.0);
  vec3 dot_ = ink < 0.5 ? BLACK : ink < 1.5 ? GREEN : ink < 2.5 ? WHITE : RED;
  float inside = 1.0 - smoothstep(1.0 - soft, 1.0 + soft, length(at - (2.0 + 3.0 * cell)));
  vec3 colour = mix(BLACK, dot_, inside);
  float border = min(min(at.x, at.y), min(13.0 - at.x, 13.0 - at.y));
  colour = mix(uEdge, gl_FrontFacing ? colour : uBack, smoothstep(0.25, 0.25 + soft, border));
  gl_FragColor = vec4(colour, 1.0);
}`;

/** Digits of a code and the red base dots, two bits a cell, eight cells a number. */
function cellsOf(code) {
  const inks = new Array(CELLS).fill(RED);
  for (let cell = CELLS - 1, rest = code; cell >= 0; cell -= 1) {
    if (BASE_CELLS.includes(cell)) continue;
    inks[cell] = rest % 3;
    rest = Math.floor(rest / 3);
  }
  const packed = (eight) => eight.reduce((sum, ink, place) => sum + ink * 4 ** place, 0);
  return [packed(inks.slice(0, 8)), packed(inks.slice(8))];
}

/**
 * Plates at their places.
 * @param {Array<{code: number, position_m: number[], orientation_xyzw: number[]}>} targets
 * @param {number} u_m module of the plates
 * @returns {InstancedMesh} whose instances are in the targets' order
 */
export function makePlates(targets, u_m) {
  const geometry = new PlaneGeometry(1, 1);
  geometry.setAttribute("aCells", new InstancedBufferAttribute(new Float32Array(targets.flatMap((target) => cellsOf(target.code))), 2));
  const uniforms = { uEdge: { value: new Vector3() }, uBack: { value: new Vector3() }, uHeight_px: { value: 1 } };
  const mesh = new InstancedMesh(geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, side: DoubleSide }), targets.length);
  const size = new Vector3(SIDE_U * u_m, SIDE_U * u_m, 1);
  targets.forEach((target, index) => mesh.setMatrixAt(index, new Matrix4().compose(new Vector3(...target.position_m), new Quaternion(...target.orientation_xyzw), size)));
  mesh.userData.paint = (colours) => {
    uniforms.uEdge.value.setFromColor(asShown(colours.strongLine));
    uniforms.uBack.value.setFromColor(asShown(colours.line));
  };
  mesh.userData.resize = (_, height_px) => { uniforms.uHeight_px.value = height_px; };
  return mesh;
}
