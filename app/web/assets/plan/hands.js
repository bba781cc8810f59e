// Mouse and fingers on a plan: one drags, two pinch, the wheel zooms, a hover inspects.
import { nearestPoint } from "./track.js";
import { panned, zoomed } from "./view.js";

const WHEEL = 0.0015; // of a zoom, for each pixel of the wheel
const REACH_PX = 16; // of a mouse; fingers are broader
const FINGER_PX = 28;

/**
 * Follow what hands do on a canvas.
 * @param {HTMLCanvasElement} canvas
 * @param {{current: object}} view the present one
 * @param {(view: object) => void} look shows another one
 * @param {() => Array<[number, number]>} points that can be inspected
 * @param {{set: (index: number | null, by: unknown) => void}} pointer
 * @returns {() => void} an end to it
 */
export function followHands(canvas, view, look, points, pointer) {
  const held = new Map();
  const inspect = (event) => pointer.set(nearestPoint(view.current, points(), placeOf(event), event.pointerType === "touch" ? FINGER_PX : REACH_PX));
  const handlers = {
    pointerdown(event) {
      held.set(event.pointerId, placeOf(event));
      canvas.setPointerCapture(event.pointerId);
      inspect(event);
    },
    pointermove(event) {
      const before = held.get(event.pointerId);
      if (!before) return inspect(event);
      const now = placeOf(event);
      const other = [...held].find(([id]) => id !== event.pointerId)?.[1];
      held.set(event.pointerId, now);
      if (other) look(pinched(view.current, other, before, now));
      else if (now[0] !== before[0] || now[1] !== before[1]) look(panned(view.current, now[0] - before[0], now[1] - before[1]));
    },
    pointerup: (event) => held.delete(event.pointerId),
    pointercancel: (event) => held.delete(event.pointerId),
    pointerleave: () => held.size || pointer.set(null),
    wheel(event) {
      event.preventDefault();
      look(zoomed(view.current, Math.exp(-event.deltaY * WHEEL), placeOf(event)));
    },
  };
  for (const [name, handle] of Object.entries(handlers)) canvas.addEventListener(name, handle, { passive: false });
  return () => { for (const [name, handle] of Object.entries(handlers)) canvas.removeEventListener(name, handle); };
}

const placeOf = (event) => [event.offsetX, event.offsetY];

/** One finger stays at `other`, the other goes from `before` to `now`. */
function pinched(view, other, before, now) {
  const apart = ([x, y]) => Math.max(Math.hypot(x - other[0], y - other[1]), 1);
  return zoomed(view, apart(now) / apart(before), other);
}
