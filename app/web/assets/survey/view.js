// What part of a picture is seen: its centre (picture pixels) and its scale (screen pixels per picture pixel).

const GREATEST_SCALE = 64;
const LEAST_OF_FIT = 0.5; // a picture may shrink to half of what fits

/** The view that shows a whole picture in a frame. */
export function fit(picture, frame) {
  const scale = Math.min(frame.width / picture.width_px, frame.height / picture.height_px) || 1;
  return { x_px: (picture.width_px - 1) / 2, y_px: (picture.height_px - 1) / 2, scale };
}

/** The view that shows a box of the picture with some room around it. */
export function closeUp(box, frame) {
  const scale = Math.min(GREATEST_SCALE, frame.width / (box.width_px * 2), frame.height / (box.height_px * 2));
  return { x_px: box.x_px, y_px: box.y_px, scale };
}

/** The box around points. */
export function boxOf(points) {
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  return { x_px: (left + right) / 2, y_px: (top + bottom) / 2, width_px: Math.max(right - left, 8), height_px: Math.max(bottom - top, 8) };
}

/** Where a point of the frame is in the picture. */
export const pictureOf = (view, frame, [x, y]) => [view.x_px + (x - frame.width / 2) / view.scale, view.y_px + (y - frame.height / 2) / view.scale];

/** Zoom by a factor about a point of the frame, which stays where it is. */
export function zoom(view, frame, picture, factor, point = [frame.width / 2, frame.height / 2]) {
  const least = LEAST_OF_FIT * fit(picture, frame).scale;
  const scale = Math.min(GREATEST_SCALE, Math.max(least, view.scale * factor));
  const [x_px, y_px] = pictureOf(view, frame, point);
  return within({ x_px: x_px - (point[0] - frame.width / 2) / scale, y_px: y_px - (point[1] - frame.height / 2) / scale, scale }, picture);
}

/** Move by screen pixels, as a hand moves a sheet of paper. */
export const pan = (view, picture, dx, dy) => within({ ...view, x_px: view.x_px - dx / view.scale, y_px: view.y_px - dy / view.scale }, picture);

/** The picture never leaves the frame altogether. */
const within = (view, picture) => ({ ...view, x_px: Math.min(picture.width_px, Math.max(0, view.x_px)), y_px: Math.min(picture.height_px, Math.max(0, view.y_px)) });

/** The view as SVG's viewBox. */
export const viewBoxOf = (view, frame) => [view.x_px - frame.width / 2 / view.scale, view.y_px - frame.height / 2 / view.scale, frame.width / view.scale, frame.height / view.scale].join(" ");
