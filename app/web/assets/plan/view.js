// Which part of the plan is seen: metres of the site (x right, y up) to pixels of the picture and back.

const LEAST_SPAN_M = 0.2; // of a plan of a single place
const AROUND = 1.15; // of what is fitted, so that nothing touches the edge
export const MARGIN_PX = { left: 48, bottom: 28, right: 12, top: 12 }; // where the axes stand
const SCALES_PX_M = [0.05, 100_000]; // from a region to a tenth of a millimetre
const STEPS = [1, 2, 5];

/** Least and greatest of some points, [x_min, y_min, x_max, y_max] in metres; null for none. */
export function boundsOf(points) {
  let found = null;
  for (const [x, y] of points) {
    found ??= [x, y, x, y];
    if (x < found[0]) found[0] = x;
    if (y < found[1]) found[1] = y;
    if (x > found[2]) found[2] = x;
    if (y > found[3]) found[3] = y;
  }
  return found;
}

/** The view that shows bounds whole. */
export function fitted(bounds, width_px, height_px) {
  const [x_min, y_min, x_max, y_max] = bounds ?? [0, 0, 1, 1];
  const [wide_px, high_px] = [width_px - MARGIN_PX.left - MARGIN_PX.right, height_px - MARGIN_PX.top - MARGIN_PX.bottom];
  const span = (low, high) => Math.max(high - low, LEAST_SPAN_M) * AROUND;
  const scale_px_m = Math.max(Math.min(wide_px / span(x_min, x_max), high_px / span(y_min, y_max)), SCALES_PX_M[0]);
  return { x_m: (x_min + x_max) / 2, y_m: (y_min + y_max) / 2, scale_px_m, width_px, height_px };
}

const middle_px = (view) => [(MARGIN_PX.left + view.width_px - MARGIN_PX.right) / 2, (MARGIN_PX.top + view.height_px - MARGIN_PX.bottom) / 2];

/** Functions from metres to pixels of a view: `[toX, toY]`. */
export function pixelsOf(view) {
  const [left, top] = middle_px(view);
  return [(x_m) => left + (x_m - view.x_m) * view.scale_px_m, (y_m) => top - (y_m - view.y_m) * view.scale_px_m];
}

/** The place under a pixel, metres. */
export function placeAt(view, x_px, y_px) {
  const [left, top] = middle_px(view);
  return [view.x_m + (x_px - left) / view.scale_px_m, view.y_m - (y_px - top) / view.scale_px_m];
}

export const panned = (view, dx_px, dy_px) => ({ ...view, x_m: view.x_m - dx_px / view.scale_px_m, y_m: view.y_m + dy_px / view.scale_px_m });

/** Larger by a factor; the place under the pixel (default: the middle) stays. */
export function zoomed(view, factor, [x_px, y_px] = middle_px(view)) {
  const scale_px_m = Math.min(Math.max(view.scale_px_m * factor, SCALES_PX_M[0]), SCALES_PX_M[1]);
  const [x_m, y_m] = placeAt(view, x_px, y_px);
  const share = view.scale_px_m / scale_px_m;
  return { ...view, scale_px_m, x_m: x_m + (view.x_m - x_m) * share, y_m: y_m + (view.y_m - y_m) * share };
}

/** The same part seen in a picture of another size. */
export const resized = (view, width_px, height_px) => ({ ...view, width_px, height_px });

/** The round length (1, 2 or 5 times a power of ten) that is nearest below a length. */
export function roundBelow(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * STEPS.findLast((step) => step * power <= length * (1 + 1e-9));
}

/** Round places of an axis within [low, high], about `spacing` apart. */
export function ticks(low, high, spacing) {
  const step = roundBelow(spacing);
  const found = [];
  for (let index = Math.ceil(low / step); index * step <= high; index += 1) found.push(index * step);
  return { step, places: found };
}

/** A length as text with its unit; of `step` its decimals. */
export function lengthText(value_m, step_m = value_m) {
  const decimals = Math.max(0, -Math.floor(Math.log10(Math.abs(step_m) || 1)));
  return value_m.toFixed(Math.min(decimals, 4));
}
