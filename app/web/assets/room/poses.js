// Located poses of all trajectories in two draw calls: arrows that look as the camera did, and dots without a direction.
import { ConeGeometry, InstancedMesh, Matrix4, MeshLambertMaterial, Quaternion, SphereGeometry, Vector3 } from "/vendor/three.min.js";

const QUARTER = Math.PI / 2;
const THIN = 0.3; // an arrow's radius in its lengths

/**
 * Poses in the order given.
 * @param {Array<{position_m: number[], orientation_xyzw: number[] | null, series: number}>} poses
 * @param {number} length_m of an arrow
 * @returns {InstancedMesh[]}
 */
export function makePoses(poses, length_m) {
  const arrow = new ConeGeometry(THIN * length_m, length_m, 4).rotateX(QUARTER); // its tip along the camera's z
  const dot = new SphereGeometry(THIN * length_m, 6, 4);
  const groups = [[arrow, poses.filter((pose) => pose.orientation_xyzw)], [dot, poses.filter((pose) => !pose.orientation_xyzw)]];
  return groups.filter(([, chosen]) => chosen.length).map(([geometry, chosen]) => instances(geometry, chosen));
}

function instances(geometry, poses) {
  const mesh = new InstancedMesh(geometry, new MeshLambertMaterial(), poses.length);
  const [turn, place, size, matrix] = [new Quaternion(), new Vector3(), new Vector3(1, 1, 1), new Matrix4()];
  poses.forEach((pose, index) => {
    turn.set(...(pose.orientation_xyzw ?? [0, 0, 0, 1]));
    mesh.setMatrixAt(index, matrix.compose(place.set(...pose.position_m), turn, size));
  });
  mesh.userData.paint = (colours) => {
    poses.forEach((pose, index) => mesh.setColorAt(index, colours.series[pose.series % colours.series.length]));
    mesh.instanceColor.needsUpdate = true;
  };
  return mesh;
}
