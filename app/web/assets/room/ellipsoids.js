// One standard deviation of each target's position, enlarged so that it can be seen, in one draw call.
import { InstancedMesh, Matrix4, MeshLambertMaterial, SphereGeometry, Vector3 } from "/vendor/three.min.js";

/** By how much ellipsoids can be enlarged. */
export const SCALES = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
const THINNEST = 1e-3; // of the longest semi-axis: a direction without any error would make a matrix without an inverse

/** The enlargement at which a typical ellipsoid is as wide as a plate: an index of SCALES. */
export function fittingScale(axesOfTargets, plate_m) {
  const longest = axesOfTargets.map(({ sigmas }) => sigmas[0]).sort((first, second) => first - second);
  const typical_m = longest[Math.floor(longest.length / 2)] || plate_m;
  const above = SCALES.findIndex((scale) => 2 * scale * typical_m > plate_m);
  return Math.max(0, above < 0 ? SCALES.length - 1 : above - 1);
}

/**
 * Ellipsoids about the targets.
 * @param {Array<{position_m: number[]}>} targets
 * @returns {InstancedMesh} with `userData.shape(axesOfTargets, scale)`
 */
export function makeEllipsoids(targets) {
  const material = new MeshLambertMaterial({ transparent: true, opacity: 0.6, depthWrite: false });
  const mesh = new InstancedMesh(new SphereGeometry(1, 20, 14), material, targets.length);
  mesh.renderOrder = 1;
  mesh.userData.paint = (colours) => material.color.copy(colours.series[1]);
  mesh.userData.shape = (axesOfTargets, scale) => {
    axesOfTargets.forEach((principal, index) => mesh.setMatrixAt(index, matrixOf(targets[index].position_m, principal, scale)));
    mesh.instanceMatrix.needsUpdate = true;
    mesh.computeBoundingSphere();
  };
  return mesh;
}

function matrixOf(position_m, { sigmas, axes }, scale) {
  const semi = sigmas.map((sigma) => scale * Math.max(sigma, THINNEST * sigmas[0]));
  const columns = axes.map((axis, index) => new Vector3(...axis).multiplyScalar(semi[index]));
  return new Matrix4().makeBasis(...columns).setPosition(...position_m);
}
