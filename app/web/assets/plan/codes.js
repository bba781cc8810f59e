// Codes beside their plates on a plan: each where it covers nothing else, or nowhere; closer to, there is room for more.
import { MARGIN_PX } from "./view.js";

const LINE_PX = 14; // the height of a line of text
const BESIDE_PX = 5; // between a plate and its code
const BUTTONS_PX = { wide: 48, high: 124 }; // of a plan's corner, top right, where its buttons stand
const BAR_PX = { wide: 172, high: 58 }; // and of the one below, where the scale bar and the axis' name stand
const NAME_PX = { wide: 40, high: 20 }; // and of the one top left, where the other axis' name stands

/** @typedef {[number, number, number, number]} Box left, top, right, bottom, pixels */

/** @param {Array<[number, number]>} points @returns {Box} */
export function boxOf(points) {
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/**
 * Write codes in the context's font and colour.
 * @param {CanvasRenderingContext2D} context
 * @param {{width_px: number, height_px: number}} view
 * @param {Array<{text: string, plate: Box}>} codes
 */
export function drawCodes(context, view, codes) {
  const { left, top, right, bottom } = MARGIN_PX;
  const inside = [left, top, view.width_px - right, view.height_px - bottom];
  const seen = codes.filter(({ plate }) => overlap(plate, inside));
  const plates = seen.map(({ plate }) => plate);
  const taken = reserved(inside);
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const { text, plate } of seen) {
    const wide = context.measureText(text).width;
    const box = placesBeside(plate, wide).find((place) => within(place, inside) && ![...taken, ...plates].some((other) => overlap(place, other)));
    if (!box) continue;
    taken.push(box);
    context.fillText(text, (box[0] + box[2]) / 2, (box[1] + box[3]) / 2);
  }
}

/** Corners that hold something else. */
const reserved = ([left, top, right, bottom]) => [
  [right - BUTTONS_PX.wide, top, right, top + BUTTONS_PX.high],
  [right - BAR_PX.wide, bottom - BAR_PX.high, right, bottom],
  [left, top, left + NAME_PX.wide, top + NAME_PX.high],
];

/** Where a code may stand: above its plate, below, on the right, on the left. @returns {Box[]} */
function placesBeside([left, top, right, bottom], wide) {
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  const around = (middle_x, middle_y) => [middle_x - wide / 2, middle_y - LINE_PX / 2, middle_x + wide / 2, middle_y + LINE_PX / 2];
  const [aside, along] = [BESIDE_PX + wide / 2, BESIDE_PX + LINE_PX / 2];
  return [around(x, top - along), around(x, bottom + along), around(right + aside, y), around(left - aside, y)];
}

const overlap = (one, other) => one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];
const within = (one, other) => one[0] >= other[0] && one[1] >= other[1] && one[2] <= other[2] && one[3] <= other[3];
