// How far off a target may be: its own part and the datum's, and the ellipsoid that shows both.

/**
 * Covariance of a target's position in the site frame.
 * @param {{position_m: number[], covariance: number[][]}} target its own part, 6 x 6
 * @param {{origin_m: number[], covariance: number[][]} | null} datum the shared part, 7 x 7; null leaves it out
 * @returns {number[][]} 3 x 3, m²
 */
export function positionCovariance(target, datum) {
  const own = target.covariance.slice(0, 3).map((row) => row.slice(0, 3));
  if (!datum) return own;
  const [x, y, z] = target.position_m.map((value, axis) => value - datum.origin_m[axis]);
  // A point moves by translation + rotation x offset + log-scale * offset.
  const jacobian = [[1, 0, 0, 0, z, -y, x], [0, 1, 0, -z, 0, x, y], [0, 0, 1, y, -x, 0, z]];
  const half = jacobian.map((row) => datum.covariance[0].map((_, column) => row.reduce((sum, value, inner) => sum + value * datum.covariance[inner][column], 0)));
  return own.map((row, i) => row.map((value, j) => value + half[i].reduce((sum, part, inner) => sum + part * jacobian[j][inner], 0)));
}

const SWEEPS = 12; // Jacobi's method converges quadratically: six suffice for doubles, and a sweep is nine products
const PAIRS = [[0, 1], [0, 2], [1, 2]];

/**
 * Principal axes of a covariance by Jacobi's rotations (Golub and Van Loan, section 8.5).
 * @param {number[][]} covariance 3 x 3
 * @returns {{sigmas: number[], axes: number[][]}} semi-axes, the longest first, and a unit vector for each
 */
export function principalAxes(covariance) {
  const a = covariance.map((row) => [...row]);
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < SWEEPS; sweep += 1) for (const [p, q] of PAIRS) rotate(a, v, p, q);
  const order = [0, 1, 2].sort((first, second) => a[second][second] - a[first][first]);
  return { sigmas: order.map((i) => Math.sqrt(Math.max(a[i][i], 0))), axes: order.map((i) => v.map((row) => row[i])) };
}

/** One rotation in the plane of two axes, after which they are uncorrelated. */
function rotate(a, v, p, q) {
  if (a[p][q] === 0) return;
  const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1));
  const c = 1 / Math.hypot(t, 1);
  const s = t * c;
  for (const row of a) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
  [a[p], a[q]] = [a[p].map((value, k) => c * value - s * a[q][k]), a[p].map((value, k) => s * value + c * a[q][k])];
  for (const row of v) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
}
