// What a set of photographs shows of a camera: how many, where in the picture targets fell, near and far, turned.
// The limits are those by which the service judges (photogrammetry/calibration/carried.py) and words its advice.

export const FEWEST = 5;
export const ENOUGH = 20;
const CELLS = [6, 4]; // columns and rows
const GOOD_COVER = 0.7; // share of the cells
const GOOD_DEPTH_RATIO = 1.3;
const GOOD_TURNED = 0.15; // share of the photographs
const CORNERS = [0, 3, 15, 12]; // dots at a plate's corners, row-major, going round

/** Corners of a plate's dots, sensor pixels. */
export const cornersOf = (target) => CORNERS.map((dot) => target.dots_px[dot]);

const lengthOf = ([x, y]) => Math.hypot(x, y);
const less = (to, from) => [to[0] - from[0], to[1] - from[1]];

/** How large a plate is in the picture, px: the longer diagonal, which a slanting view shortens least. */
const sizeOf = (target) => Math.max(lengthOf(less(target.dots_px[15], target.dots_px[0])), lengthOf(less(target.dots_px[3], target.dots_px[12])));

/** Whether most plates of a photograph lie on their side. */
const lies = (targets) => targets.filter((target) => { const [x, y] = less(target.dots_px[0], target.dots_px[12]); return Math.abs(x) > Math.abs(y); }).length > targets.length / 2;

/** The photographs that take part: those of the size that most have, with targets. */
export function usable(detections) {
  const seen = detections.filter((detection) => detection.targets.length > 0);
  const counts = new Map();
  for (const { width_px, height_px } of seen) counts.set(`${width_px} ${height_px}`, (counts.get(`${width_px} ${height_px}`) ?? 0) + 1);
  const [size] = [...counts].sort((first, second) => second[1] - first[1])[0] ?? [];
  return seen.filter(({ width_px, height_px }) => `${width_px} ${height_px}` === size);
}

/**
 * What the photographs show together.
 * @param {Array<{width_px: number, height_px: number, targets: Array<{dots_px: number[][], measured: boolean[]}>}>} photos of one size
 */
export function measuresOf(photos) {
  const cells = emptyCells();
  for (const photo of photos) for (const target of photo.targets) fill(cells, photo, target);
  const filled = cells.flat().filter(Boolean).length;
  const turned = photos.filter((photo) => lies(photo.targets)).length;
  return { count: photos.length, cells, cover: filled / (CELLS[0] * CELLS[1]), depth_ratio: median(photos.map(depthRatio)), turned: Math.min(turned, photos.length - turned) };
}

const emptyCells = () => Array.from({ length: CELLS[1] }, () => Array(CELLS[0]).fill(0));

/** Count a plate's dots in the cells of the picture. */
function fill(cells, photo, target) {
  target.dots_px.forEach(([x, y], dot) => {
    if (!target.measured[dot]) return;
    const at = (value, size, count) => Math.min(count - 1, Math.max(0, Math.floor((value / size) * count)));
    cells[at(y, photo.height_px, CELLS[1])][at(x, photo.width_px, CELLS[0])] += 1;
  });
}

/** Farthest over nearest target of a photograph, by their sizes in it. */
function depthRatio(photo) {
  const sizes = photo.targets.map(sizeOf);
  return Math.max(...sizes) / Math.min(...sizes);
}

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length ? (sorted[(sorted.length - 1) >> 1] + sorted[sorted.length >> 1]) / 2 : 0;
}

/** What is good and what is lacking, in the order in which to see to it. */
export function checksOf({ count, cover, depth_ratio, turned }) {
  const percent = Math.round(100 * cover);
  return [
    { name: "Photographs", good: count >= FEWEST, text: count < FEWEST ? `${count} show targets; ${FEWEST - count} more, better some twelve` : `${count} show targets${count > ENOUGH ? "; twenty are enough" : ""}` },
    { name: "Near and far", good: depth_ratio >= GOOD_DEPTH_RATIO, text: depth_ratio >= GOOD_DEPTH_RATIO ? `targets ${depth_ratio.toFixed(1)} times as far as others in one picture` : "show near and far targets together, or look along a wall at 30 to 60 degrees: from the front, focal length and distance cannot be told apart" },
    { name: "Corners filled", good: cover >= GOOD_COVER, text: `${percent} % of the picture hold dots${cover >= GOOD_COVER ? "" : "; let targets stand in the parts that are marked"}` },
    { name: "Phone turned", good: count > 0 && turned / count >= GOOD_TURNED, text: turned ? `${turned} of ${count} by a quarter turn` : "turn the phone by a quarter turn for every third photograph" },
  ];
}
