// Signs of constant size on the screen: control and check points as surveyors draw them, a ring about what is picked.
import { BufferAttribute, BufferGeometry, Points, ShaderMaterial, Vector3 } from "/vendor/three.min.js";
import { asShown } from "./palette.js";

/** What a sign looks like: a ring, a triangle with its point (control), a circle with its point (check). */
export const SIGNS = { ring: 0, control: 1, check: 2 };
const SIZE_PX = { ring: 34, point: 20 };

const VERTEX = `
attribute float aSign;
flat varying float vSign;
uniform float uRatio;
void main() {
  vSign = aSign;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = uRatio * (aSign < 0.5 ? ${SIZE_PX.ring}.0 : ${SIZE_PX.point}.0);
}`;

// Distances in halves of the sign's size, from its middle; lines are a tenth wide.
const FRAGMENT = `
flat varying float vSign;
uniform vec3 uRing;
uniform vec3 uControl;
uniform vec3 uCheck;
uniform vec3 uGround;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float from_middle = length(at);
  bool triangle = vSign > 0.5 && vSign < 1.5;
  float from_edge = triangle ? max(at.y - 0.6, abs(at.x) * 0.866 - at.y * 0.5 - 0.42) : from_middle - 0.75;
  float line = 1.0 - smoothstep(0.08, 0.14, abs(from_edge));
  float dot_ = vSign < 0.5 ? 0.0 : 1.0 - smoothstep(0.12, 0.2, length(at - vec2(0.0, triangle ? 0.1 : 0.0)));
  float halo = vSign < 0.5 ? 0.0 : 0.75 * (1.0 - smoothstep(0.08, 0.12, from_edge));
  float drawn = max(line, dot_);
  if (max(drawn, halo) < 0.05) discard;
  vec3 ink = vSign < 0.5 ? uRing : triangle ? uControl : uCheck;
  gl_FragColor = vec4(mix(uGround, ink, drawn), max(drawn, halo));
}`;

/**
 * Signs at their places, drawn over everything else.
 * @param {Array<{position_m: number[], sign: number}>} items
 * @param {number} ratio device pixels per CSS pixel
 */
export function makeMarkers(items, ratio) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(items.flatMap((item) => item.position_m)), 3));
  geometry.setAttribute("aSign", new BufferAttribute(new Float32Array(items.map((item) => item.sign)), 1));
  const uniforms = { uRatio: { value: ratio }, ...Object.fromEntries(["uRing", "uControl", "uCheck", "uGround"].map((name) => [name, { value: new Vector3() }])) };
  const points = new Points(geometry, new ShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, transparent: true, depthTest: false }));
  points.frustumCulled = false;
  points.renderOrder = 3;
  points.userData.paint = (colours) => {
    for (const [name, colour] of [["uRing", colours.accent], ["uControl", colours.control], ["uCheck", colours.check], ["uGround", colours.ground]]) uniforms[name].value.setFromColor(asShown(colour));
  };
  return points;
}
