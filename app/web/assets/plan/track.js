// Positions on a plan: thousands of dots and the way between them, as many as there are pixels to show them.
import { pixelsOf } from "./view.js";

const DOT_PX = 3;
const CELL_PX = 2; // of two dots in one cell the first is drawn
const OUTSIDE_PX = 20; // beyond the edge nothing is drawn
const LEAST_STEP_PX = 1.5; // of the way's strokes

/**
 * Dots in colours.
 * @param {Array<[number, number]>} points metres
 * @param {(index: number) => number} shadeOf a dot's colour, as its place in `shades`; -1 leaves it out
 * @param {string[]} shades
 */
export function drawDots(context, view, points, shadeOf, shades, dot_px = DOT_PX) {
  const [toX, toY] = pixelsOf(view);
  const across = Math.ceil(view.width_px / CELL_PX);
  const taken = new Uint8Array(across * (Math.ceil(view.height_px / CELL_PX) + 1));
  const paths = shades.map(() => new Path2D());
  points.forEach(([x_m, y_m], index) => {
    const [x, y, shade] = [toX(x_m), toY(y_m), shadeOf(index)];
    if (shade < 0 || !(x >= 0 && y >= 0 && x < view.width_px && y < view.height_px)) return;
    const cell = Math.floor(y / CELL_PX) * across + Math.floor(x / CELL_PX);
    if (taken[cell]) return;
    taken[cell] = 1;
    paths[shade].moveTo(x + dot_px, y);
    paths[shade].arc(x, y, dot_px, 0, 2 * Math.PI);
  });
  paths.forEach((path, shade) => { context.fillStyle = shades[shade]; context.fill(path); });
}

/** The way from point to point; `broken(index)` says that none leads to a point. */
export function drawWay(context, view, points, broken, stroke, width_px = 1) {
  const [toX, toY] = pixelsOf(view);
  const near = (x, y) => x > -OUTSIDE_PX && y > -OUTSIDE_PX && x < view.width_px + OUTSIDE_PX && y < view.height_px + OUTSIDE_PX;
  context.strokeStyle = stroke;
  context.lineWidth = width_px;
  context.beginPath();
  let from = null;
  points.forEach(([x_m, y_m], index) => {
    const to = [toX(x_m), toY(y_m)];
    if (from === null || broken(index)) context.moveTo(...to);
    else if (index < points.length - 1 && Math.hypot(to[0] - from[0], to[1] - from[1]) < LEAST_STEP_PX) return;
    else near(...from) || near(...to) ? context.lineTo(...to) : context.moveTo(...to);
    from = to;
  });
  context.stroke();
}

/** The point nearest to a pixel, no farther than `reach_px`; null for none. */
export function nearestPoint(view, points, [x_px, y_px], reach_px) {
  const [toX, toY] = pixelsOf(view);
  let [best, least] = [null, reach_px];
  points.forEach(([x_m, y_m], index) => {
    const away = Math.hypot(toX(x_m) - x_px, toY(y_m) - y_px);
    if (away < least) [best, least] = [index, away];
  });
  return best;
}
