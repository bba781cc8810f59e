// A photograph as the sensor's rows lie, and the same turned upright: where a pixel of one is in the other.
// Pixel (0, 0) is the centre of the top-left pixel, so that a picture begins at -0.5.

/**
 * @param {{width_px: number, height_px: number, quarter_turns: number}} photo quarter turns clockwise
 */
export function uprightOf({ width_px, height_px, quarter_turns }) {
  const [right, bottom] = [width_px - 1, height_px - 1];
  // Matrices of SVG: x' = a x + c y + e, y' = b x + d y + f.
  const [a, b, c, d, e, f] = [[1, 0, 0, 1, 0, 0], [0, 1, -1, 0, bottom, 0], [-1, 0, 0, -1, right, bottom], [0, -1, 1, 0, 0, right]][quarter_turns];
  const turned = quarter_turns % 2 === 1;
  return {
    width_px: turned ? height_px : width_px,
    height_px: turned ? width_px : height_px,
    transform: `matrix(${[a, b, c, d, e, f]})`,
    /** From the sensor's rows to the upright picture. */
    toUpright: ([x, y]) => [a * x + c * y + e, b * x + d * y + f],
    /** And back: a turn's inverse is its transpose. */
    toSensor: ([x, y]) => [a * (x - e) + b * (y - f), c * (x - e) + d * (y - f)],
  };
}
