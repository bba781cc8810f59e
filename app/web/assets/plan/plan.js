// A plan to look at: zoomed by wheel, pinch, keys and buttons, panned by dragging, its points inspected by pointing or by keys.
import { html, useEffect, useLayoutEffect, useRef, useState } from "../core/html.js";
import { Button } from "../ui/parts.js";
import { colour, useTheme } from "../ui/theme.js";
import { drawFrame, drawScaleBar } from "./draw.js";
import { followHands } from "./hands.js";
import { fitted, MARGIN_PX, panned, pixelsOf, resized, zoomed } from "./view.js";

const ZOOM = 1.3;
const PAN_PX = 60;
const RING_PX = 7;

/**
 * @param {object} given
 * @param {string} given.label what it shows
 * @param {[number, number, number, number] | null} given.bounds what to fit, metres
 * @param {(context: CanvasRenderingContext2D, view: object) => void} given.draw all between the axes and the scale bar
 * @param {unknown[]} given.keys what `draw` rests on
 * @param {Array<[number, number]>} given.points that can be inspected, metres
 * @param {{get, set, listen}} given.pointer shared index of the point that is pointed at
 */
export function Plan({ label, bounds, draw, keys, points, pointer }) {
  const [place, under, over, view, latest] = [useRef(null), useRef(null), useRef(null), useRef(null), useRef(null)];
  const [fits, setFits] = useState(true);
  const theme = useTheme();
  latest.current = { bounds, draw, points };
  const frame = useRef(0); // of several wishes between two frames one is drawn
  const redraw = () => {
    cancelAnimationFrame(frame.current);
    frame.current = requestAnimationFrame(() => { paint(under.current, view.current, latest.current.draw); ring(over.current, view.current, latest.current.points, pointer.get()); });
  };
  const look = (next, whole = false) => { view.current = next; setFits(whole); redraw(); };
  const fit = () => look(fitted(latest.current.bounds, view.current.width_px, view.current.height_px), true);
  // Ends as the plan leaves the page; other effects end a moment later, when there is nothing left to draw on.
  useLayoutEffect(() => {
    const around = place.current;
    const follow = () => {
      const [width_px, height_px] = [around.clientWidth, around.clientHeight];
      if (!width_px || !height_px) return;
      [under.current, over.current].forEach((canvas) => size(canvas, width_px, height_px));
      view.current = view.current && !latest.current.fits ? resized(view.current, width_px, height_px) : fitted(latest.current.bounds, width_px, height_px);
      redraw();
    };
    follow(); // keys and buttons find a view from the start
    const observer = new ResizeObserver(follow);
    observer.observe(around);
    const ends = [followHands(over.current, view, look, () => latest.current.points, pointer), pointer.listen(() => ring(over.current, view.current, latest.current.points, pointer.get()))];
    return () => { cancelAnimationFrame(frame.current); observer.disconnect(); ends.forEach((end) => end()); };
  }, [pointer]);
  latest.current.fits = fits;
  useEffect(() => { if (view.current) fits ? fit() : redraw(); }, [...keys, theme, String(bounds)]);
  const onKey = (event) => { if (keyed(event.key, { view: view.current, look, fit, pointer, count: points.length, shift: event.shiftKey })) event.preventDefault(); };
  return html`<div class="plan" ref=${place}>
    <canvas ref=${under} aria-hidden="true"></canvas>
    <canvas ref=${over} class="plan-over" tabindex="0" role="img" aria-label=${`${label}. Arrow keys go from point to point, with Shift they move the plan; + and - zoom, 0 shows all.`} onKeyDown=${onKey}></canvas>
    <div class="plan-buttons"><${Button} aria-label="Zoom in" onClick=${() => look(zoomed(view.current, ZOOM))}>+</${Button}><${Button} aria-label="Zoom out" onClick=${() => look(zoomed(view.current, 1 / ZOOM))}>−</${Button}><${Button} aria-label="Show all" disabled=${fits} onClick=${fit}>⤢</${Button}></div>
  </div>`;
}

function size(canvas, width_px, height_px) {
  canvas.width = Math.round(width_px * devicePixelRatio);
  canvas.height = Math.round(height_px * devicePixelRatio);
}

function paint(canvas, view, draw) {
  const context = cleared(canvas);
  drawFrame(context, view);
  context.save();
  context.beginPath();
  context.rect(MARGIN_PX.left, MARGIN_PX.top, view.width_px - MARGIN_PX.left - MARGIN_PX.right, view.height_px - MARGIN_PX.top - MARGIN_PX.bottom);
  context.clip();
  draw(context, view);
  context.restore();
  drawScaleBar(context, view);
}

function ring(canvas, view, points, index) {
  const context = cleared(canvas);
  if (!view || index === null || !points[index]) return;
  const [toX, toY] = pixelsOf(view);
  context.strokeStyle = colour("ink");
  context.lineWidth = 2;
  context.beginPath();
  context.arc(toX(points[index][0]), toY(points[index][1]), RING_PX, 0, 2 * Math.PI);
  context.stroke();
}

function cleared(canvas) {
  const context = canvas.getContext("2d");
  context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  return context;
}

/** What a key does; whether it did anything. */
function keyed(key, { view, look, fit, pointer, count, shift }) {
  const pan = { ArrowLeft: [PAN_PX, 0], ArrowRight: [-PAN_PX, 0], ArrowUp: [0, PAN_PX], ArrowDown: [0, -PAN_PX] }[key];
  const step = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1, PageUp: -100, PageDown: 100, Home: -Infinity, End: Infinity }[key];
  if (pan && shift) look(panned(view, ...pan));
  else if (key === "+" || key === "=") look(zoomed(view, ZOOM));
  else if (key === "-") look(zoomed(view, 1 / ZOOM));
  else if (key === "0") fit();
  else if (step && count) pointer.set(Math.min(Math.max((pointer.get() ?? (step > 0 ? -1 : count)) + step, 0), count - 1));
  else return false;
  return true;
}
