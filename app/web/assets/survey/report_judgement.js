// When a control or check point is doubtful: as the report that is signed has it.
export const DOUBTFUL_SIGMAS = 3;

/**
 * The largest of a point's three residuals over its sigma; a check point's holds the target's own, too.
 * @returns {number | null} null when its target is not in the map
 */
export function largestSigmas(point, targets) {
  if (!point.residual_m) return null;
  const own = point.role === "check" ? targets.find((candidate) => candidate.code === point.code)?.sigma_m : [0, 0, 0];
  if (!own) return null; // its target carries the point and is too weakly seen for the map
  return Math.max(...point.residual_m.map((residual_m, axis) => Math.abs(residual_m) / Math.hypot(point.sigma_m, own[axis])));
}
