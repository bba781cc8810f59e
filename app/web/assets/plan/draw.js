// What stands on every plan: axes in metres, a scale bar, the targets.
import { colour } from "../ui/theme.js";
import { boxOf, drawCodes } from "./codes.js";
import { lengthText, MARGIN_PX, pixelsOf, placeAt, roundBelow, ticks } from "./view.js";

const FONT = "12px system-ui, sans-serif";
const BETWEEN_TICKS_PX = 90;
const BAR_PX = 140; // at most
const PLATE_U = 6.5; // half a plate's side, in modules

/** Grid, axes and scale bar. */
export function drawFrame(context, view) {
  context.font = FONT;
  const { left, bottom, right, top } = MARGIN_PX;
  const [low, high] = [placeAt(view, left, view.height_px - bottom), placeAt(view, view.width_px - right, top)];
  const [toX, toY] = pixelsOf(view);
  const across = ticks(low[0], high[0], BETWEEN_TICKS_PX / view.scale_px_m);
  const up = ticks(low[1], high[1], BETWEEN_TICKS_PX / view.scale_px_m);
  context.strokeStyle = colour("line");
  context.lineWidth = 1;
  context.beginPath();
  for (const x_m of across.places) { context.moveTo(crisp(toX(x_m)), top); context.lineTo(crisp(toX(x_m)), view.height_px - bottom); }
  for (const y_m of up.places) { context.moveTo(left, crisp(toY(y_m))); context.lineTo(view.width_px - right, crisp(toY(y_m))); }
  context.stroke();
  context.fillStyle = colour("muted");
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const x_m of across.places) context.fillText(lengthText(x_m, across.step), toX(x_m), view.height_px - bottom + 6);
  context.fillText("x, m", view.width_px - right - 14, view.height_px - bottom + 6 - 20);
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const y_m of up.places) context.fillText(lengthText(y_m, up.step), left - 6, toY(y_m));
  context.textAlign = "left";
  context.fillText("y, m", left + 6, top + 8);
}

const crisp = (value) => Math.round(value) + 0.5;

/** A bar of a round length, above the right end of the x axis. */
export function drawScaleBar(context, view) {
  const length_m = roundBelow(BAR_PX / view.scale_px_m);
  const length_px = length_m * view.scale_px_m;
  const [x, y] = [view.width_px - MARGIN_PX.right - length_px - 10, view.height_px - MARGIN_PX.bottom - 34];
  context.strokeStyle = context.fillStyle = colour("ink");
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x, y - 4); context.lineTo(x, y); context.lineTo(x + length_px, y); context.lineTo(x + length_px, y - 4);
  context.stroke();
  context.font = FONT;
  context.textAlign = "center";
  context.textBaseline = "bottom";
  context.fillText(barText(length_m), x + length_px / 2, y - 3);
}

const barText = (length_m) => (length_m >= 1 ? `${length_m} m` : length_m >= 0.01 ? `${Math.round(length_m * 100)} cm` : `${Number((length_m * 1000).toPrecision(1))} mm`);

/** Plates as they hang, seen from above: on a wall a stroke, on a floor a square. */
export function drawTargets(context, view, targets, plate_u_m) {
  const [toX, toY] = pixelsOf(view);
  context.strokeStyle = context.fillStyle = colour("target");
  context.lineWidth = 3;
  context.beginPath();
  const plates = targets.map((target) => cornersOf(target, plate_u_m).map(([x_m, y_m]) => [toX(x_m), toY(y_m)]));
  for (const plate of plates) plate.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
  context.font = FONT;
  drawCodes(context, view, targets.map((target, index) => ({ text: String(target.code), plate: boxOf(plates[index]) })));
}

function cornersOf({ position_m, orientation_xyzw: [x, y, z, w] }, plate_u_m) {
  const half_m = PLATE_U * plate_u_m;
  const along = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w)]; // the plate's x and y axes as the plan sees them
  const across = [2 * (x * y - z * w), 1 - 2 * (x * x + z * z)];
  return [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([a, b]) => [0, 1].map((axis) => position_m[axis] + half_m * (a * along[axis] + b * across[axis])));
}
