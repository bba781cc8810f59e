// Hands on a picture: wheel, drag, pinch and keys become zoom and pan; a touch without movement is a pick.
import { useLayoutEffect, useRef } from "../core/html.js";

const WHEEL_STEP = 0.0015; // a notch of a wheel, 100 units, zooms by a seventh
const KEY_ZOOM = 1.25;
const KEY_PAN_PX = 60;
const STILL_PX = 5; // a finger that moves less meant to touch

/**
 * Listen on an element.
 * @param {{current: Element}} element
 * @param {{zoom: (factor: number, point?: number[]) => void, pan: (dx: number, dy: number) => void, fit: () => void, pick: (point: number[]) => void, hover: (point: number[] | null) => void, key: (event: KeyboardEvent) => boolean, aims: () => boolean}} act
 *   `aims`: whether a single finger aims in place of moving the picture; `key` says whether it took a key.
 */
export function useGestures(element, act) {
  const latest = useRef(act);
  latest.current = act;
  useLayoutEffect(() => { // as soon as it is seen it may be touched
    const surface = element.current;
    const hands = new Hands(surface, latest);
    const listeners = { wheel: hands.wheel, pointerdown: hands.down, pointermove: hands.move, pointerup: hands.up, pointercancel: hands.cancel, pointerleave: hands.leave, keydown: hands.key };
    for (const [name, listener] of Object.entries(listeners)) surface.addEventListener(name, listener, { passive: false });
    return () => { for (const [name, listener] of Object.entries(listeners)) surface.removeEventListener(name, listener); };
  }, []);
}

class Hands {
  constructor(surface, latest) {
    this.surface = surface;
    this.latest = latest;
    this.pointers = new Map();
    this.moved = false;
    for (const name of ["wheel", "down", "move", "up", "cancel", "leave", "key"]) this[name] = this[name].bind(this);
  }

  get act() { return this.latest.current; }

  pointOf(event) {
    const box = this.surface.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  wheel(event) {
    event.preventDefault();
    this.act.zoom(Math.exp(-event.deltaY * WHEEL_STEP), this.pointOf(event));
  }

  down(event) {
    this.surface.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { start: this.pointOf(event), now: this.pointOf(event) });
    if (this.pointers.size === 1) this.moved = false;
    else this.moved = true; // two fingers pick nothing
    if (this.aiming(event)) this.act.hover(this.pointOf(event));
  }

  move(event) {
    const point = this.pointOf(event);
    const held = this.pointers.get(event.pointerId);
    if (!held || this.aiming(event)) this.act.hover(point);
    if (!held) return;
    const before = held.now;
    held.now = point;
    if (this.pointers.size === 2) this.pinch(event.pointerId, before);
    else if (this.moved || Math.hypot(point[0] - held.start[0], point[1] - held.start[1]) > STILL_PX) this.drag(event, before, point);
  }

  drag(event, before, point) {
    if (this.aiming(event)) return;
    this.moved = true;
    this.act.pan(point[0] - before[0], point[1] - before[1]);
  }

  /** Two fingers: their distance zooms, their middle moves. */
  pinch(id, before) {
    const other = [...this.pointers].find(([key]) => key !== id)[1].now;
    const { now } = this.pointers.get(id);
    const distance = (point) => Math.max(1, Math.hypot(point[0] - other[0], point[1] - other[1]));
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    this.act.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
    this.act.zoom(distance(now) / distance(before), middle);
  }

  /** A finger on the glass while something is to be marked: it hides what it points at, the loupe shows it. */
  aiming(event) { return event.pointerType === "touch" && this.pointers.size < 2 && this.act.aims(); }

  up(event) {
    const still = this.pointers.has(event.pointerId) && !this.moved;
    const aimed = this.aiming(event);
    this.pointers.delete(event.pointerId);
    if (still || (aimed && !this.moved)) this.act.pick(this.pointOf(event));
  }

  cancel(event) { this.pointers.delete(event.pointerId); }

  leave(event) { if (!this.pointers.has(event.pointerId)) this.act.hover(null); }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || this.act.key(event)) return;
    const moves = { ArrowLeft: [KEY_PAN_PX, 0], ArrowRight: [-KEY_PAN_PX, 0], ArrowUp: [0, KEY_PAN_PX], ArrowDown: [0, -KEY_PAN_PX] };
    if (event.key in moves) this.act.pan(...moves[event.key]);
    else if (["+", "="].includes(event.key)) this.act.zoom(KEY_ZOOM);
    else if (["-", "_"].includes(event.key)) this.act.zoom(1 / KEY_ZOOM);
    else if (event.key === "0") this.act.fit();
    else return;
    event.preventDefault();
  }
}
