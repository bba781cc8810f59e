// The ellipse that holds the position with 95 %: of two coordinates' covariance.

const HELD = 0.95;
const SIGMAS = Math.sqrt(-2 * Math.log(1 - HELD)); // chi-square of two degrees of freedom: 2.45

/**
 * @param {number[][]} covariance of the pose, m² in its first three rows and columns
 * @returns {{major_m: number, minor_m: number, turn_rad: number}} semi-axes, and the major one's direction from x towards y
 */
export function ellipseOf(covariance) {
  const [[xx, xy], [, yy]] = covariance;
  const [middle, apart] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  const axis = (variance) => SIGMAS * Math.sqrt(Math.max(variance, 0));
  return { major_m: axis(middle + apart), minor_m: axis(middle - apart), turn_rad: Math.atan2(2 * xy, xx - yy) / 2 };
}
