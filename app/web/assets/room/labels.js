// Codes beside their plates, all in one draw call: the digits come from one small picture. Those that would cover others are left out.
import { CanvasTexture, InstancedBufferAttribute, InstancedMesh, LinearFilter, Matrix4, PlaneGeometry, ShaderMaterial, Vector2, Vector3 } from "/vendor/three.min.js";
import { asShown } from "./palette.js";

const GLYPH_PX = { width: 30, height: 56, font: "600 48px ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', monospace", halo: 10 };
const SHOWN_PX = { width: 7, height: 13 }; // of one digit, CSS pixels
const FEW = 60; // labels that never crowd a screen; of more, those of plates too small to tell apart are left out
const SMALLEST_PLATE_PX = 13;
const ABOVE = 0.6; // of a plate's side, from its middle to its code's lower edge

const VERTEX = `
attribute vec2 aText;
attribute float aShown;
flat varying vec2 vText;
varying vec2 vUv;
uniform vec2 uViewport_px;
uniform vec2 uGlyph_px;
uniform float uPlate_m;
void main() {
  vText = aText;
  vUv = uv;
  vec4 at = projectionMatrix * modelViewMatrix * instanceMatrix * vec4(0.0, 0.0, 0.0, 1.0);
  float plate_px = 0.5 * uPlate_m * projectionMatrix[1][1] / at.w * uViewport_px.y;
  vec2 offset_px = position.xy * uGlyph_px * vec2(aText.y, 1.0) + vec2(0.0, ${ABOVE} * plate_px + uGlyph_px.y);
  at.xy += 2.0 * offset_px / uViewport_px * at.w;
  at.z -= 2e-4 * at.w; // before its own plate
  gl_Position = aShown < 0.5 ? vec4(0.0, 0.0, 2.0, 1.0) : at;
}`;

const FRAGMENT = `
flat varying vec2 vText;
varying vec2 vUv;
uniform sampler2D uDigits;
uniform vec3 uInk;
uniform vec3 uHalo;
void main() {
  int count = int(vText.y + 0.5);
  float along = vUv.x * vText.y;
  int rest = int(vText.x + 0.5);
  for (int place = count - 1; place > int(along); place--) rest /= 10;
  vec4 found = texture2D(uDigits, vec2((float(rest % 10) + fract(along)) / 10.0, vUv.y));
  if (found.g < 0.1) discard;
  gl_FragColor = vec4(mix(uHalo, uInk, found.r), found.g);
}`;

/** Ten digits side by side: red where the digit is, green where it or its halo is. */
function digitsPicture() {
  const canvas = Object.assign(document.createElement("canvas"), { width: 10 * GLYPH_PX.width, height: GLYPH_PX.height });
  const pen = canvas.getContext("2d");
  Object.assign(pen, { font: GLYPH_PX.font, textAlign: "center", textBaseline: "middle", lineJoin: "round", lineWidth: GLYPH_PX.halo, strokeStyle: "#0f0", fillStyle: "#ff0" });
  for (let digit = 0; digit < 10; digit += 1) {
    pen.save();
    pen.beginPath();
    pen.rect(digit * GLYPH_PX.width, 0, GLYPH_PX.width, GLYPH_PX.height);
    pen.clip();
    for (const draw of ["strokeText", "fillText"]) pen[draw](String(digit), (digit + 0.5) * GLYPH_PX.width, GLYPH_PX.height / 2);
    pen.restore();
  }
  // Neighbouring digits of a label come from places far apart: no smaller copies, which would be chosen at the seams.
  return Object.assign(new CanvasTexture(canvas), { minFilter: LinearFilter, generateMipmaps: false });
}

/**
 * Codes above their plates.
 * @param {Array<{code: number, position_m: number[]}>} targets
 * @param {number} plate_m side of a plate
 */
export function makeLabels(targets, plate_m) {
  const geometry = new PlaneGeometry(1, 1);
  geometry.setAttribute("aText", new InstancedBufferAttribute(new Float32Array(targets.flatMap(({ code }) => [code, String(code).length])), 2));
  const shown = new InstancedBufferAttribute(new Float32Array(targets.length), 1);
  geometry.setAttribute("aShown", shown);
  const uniforms = {
    uDigits: { value: digitsPicture() }, uInk: { value: new Vector3() }, uHalo: { value: new Vector3() }, uViewport_px: { value: new Vector2(1, 1) },
    uGlyph_px: { value: new Vector2(SHOWN_PX.width, SHOWN_PX.height) }, uPlate_m: { value: plate_m },
  };
  const mesh = new InstancedMesh(geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, depthWrite: false }), targets.length);
  targets.forEach((target, index) => mesh.setMatrixAt(index, new Matrix4().makeTranslation(...target.position_m)));
  mesh.frustumCulled = false; // its size on the screen is the shader's
  mesh.renderOrder = 2;
  mesh.userData.paint = (colours) => {
    uniforms.uInk.value.setFromColor(asShown(colours.ink));
    uniforms.uHalo.value.setFromColor(asShown(colours.ground));
  };
  mesh.userData.resize = (width_px, height_px) => uniforms.uViewport_px.value.set(width_px, height_px);
  mesh.userData.arrange = (camera, picked) => {
    const found = boxesOf(targets, plate_m, camera, uniforms.uViewport_px.value);
    shown.array.fill(0);
    for (const index of withRoom(found, targets.indexOf(picked))) shown.array[index] = 1;
    shown.needsUpdate = true;
  };
  return mesh;
}

/** Where codes would stand on the screen, as the vertex shader has it; those behind the camera and those too small are left out. */
function boxesOf(targets, plate_m, camera, viewport_px) {
  const smallest_px = targets.length > FEW ? SMALLEST_PLATE_PX : 0;
  return targets.flatMap(({ code, position_m }, index) => {
    const at = new Vector3(...position_m).applyMatrix4(camera.matrixWorldInverse);
    const [away, w] = [-at.z, camera.isPerspectiveCamera ? -at.z : 1];
    const plate_px = ((0.5 * plate_m * camera.projectionMatrix.elements[5]) / w) * viewport_px.y;
    if (w <= 0 || plate_px < smallest_px) return [];
    at.applyMatrix4(camera.projectionMatrix);
    const [x, y] = [0.5 * at.x * viewport_px.x, 0.5 * at.y * viewport_px.y + ABOVE * plate_px + SHOWN_PX.height];
    return [{ index, x, y, away, half_px: (SHOWN_PX.width * String(code).length) / 2 }];
  });
}

/** The nearest codes, and what is picked before all; of those behind them only the ones that cover none. */
function withRoom(found, picked) {
  const rank = (one) => (one.index === picked ? -1 : one.away);
  const kept = [];
  for (const one of found.sort((a, b) => rank(a) - rank(b))) {
    const covers = kept.some((other) => Math.abs(other.x - one.x) < other.half_px + one.half_px && Math.abs(other.y - one.y) < SHOWN_PX.height);
    if (!covers) kept.push(one);
  }
  return kept.map((one) => one.index);
}
