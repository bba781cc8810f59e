// Systems of an evaluation as plots use them: error vectors with their sizes.

/** Which size of an error vector is shown. */
export const SIZES = {
  plan: { label: "in the plan", of: ([x, y]) => Math.hypot(x, y), metric: "horizontal_m", letter: "C" },
  space: { label: "in space", of: ([x, y, z]) => Math.hypot(x, y, z), metric: "spatial_m", letter: "S" },
  height: { label: "in height", of: ([, , z]) => Math.abs(z), metric: "vertical_m", letter: "V" },
};

/** A system's pairs in the order of time. */
export function pairsOf({ series }) {
  return series.time_s.map((time_s, index) => ({ time_s, reference_m: series.reference_m[index], error_m: series.error_m[index] }));
}

/** Sorted sizes with the share of pairs up to each: an empirical distribution as a staircase's corners. */
export function distribution(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return { sizes_m: sorted, shares: sorted.map((_, index) => (index + 1) / sorted.length) };
}

/**
 * Columns that share one x, as charts want them; a series has null where another one alone has a value.
 * @param {Array<{xs: number[], ys: number[]}>} series each with increasing xs
 */
export function joined(series) {
  const xs = [...new Set(series.flatMap((one) => one.xs))].sort((a, b) => a - b);
  const rows = new Map(xs.map((x, row) => [x, row]));
  const columns = series.map((one) => {
    const column = new Array(xs.length).fill(null);
    one.xs.forEach((x, index) => { column[rows.get(x)] = one.ys[index]; });
    return column;
  });
  return [xs, ...columns];
}
