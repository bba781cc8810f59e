// A photograph to zoom and move in, with what was seen drawn over it.
import { html, useLayoutEffect, useMemo, useRef, useState } from "../core/html.js";
import { Button } from "../ui/parts.js";
import { useGestures } from "./gestures.js";
import { Loupe } from "./loupe.js";
import { Overlay } from "./photo_overlay.js";
import { uprightOf } from "./upright.js";
import { boxOf, closeUp, fit, pan, pictureOf, viewBoxOf, zoom } from "./view.js";

const BUTTON_ZOOM = 1.5;
const PIXELS_FROM_SCALE = 3; // from here on pixels are shown as squares: a blurred dot cannot be marked
const KEY_STEP_PX = 0.25;
const WIDEST_PX = 8192; // as the service has it

/**
 * @param {{path: string, detection: any, marks: any[], show: any, picked: string | null, focus: number[][] | null, marking: boolean, onPick: (sensor_px: number[], reach_px: number) => void, onMark: (sensor_px: number[]) => void}} given
 *   `focus`: points, sensor pixels, that shall be seen close up.
 */
export function PhotoCanvas({ path, detection, marks, show, picked, focus, marking, onPick, onMark }) {
  const surface = useRef(null);
  const frame = useFrame(surface);
  const upright = useMemo(() => uprightOf(detection), [detection]);
  const [view, setView] = useState(null);
  const [cursor, setCursor] = useState(null); // upright pixels
  const shown = view ?? fit(upright, frame);
  const change = (next) => setView((before) => next(before ?? fit(upright, frame)));
  // Before anything else is done to it: a key that comes at once finds the cross.
  useLayoutEffect(() => { if (focus) setView(closeUp(boxOf(focus.map(upright.toUpright)), frame)); }, [focus]);
  useLayoutEffect(() => setCursor(marking ? [shown.x_px, shown.y_px] : null), [marking]);
  const act = {
    zoom: (factor, point) => change((before) => zoom(before, frame, upright, factor, point)),
    pan: (dx, dy) => change((before) => pan(before, upright, dx, dy)),
    fit: () => setView(null),
    aims: () => marking,
    hover: (point) => { if (marking && point) setCursor(pictureOf(shown, frame, point)); },
    pick: (point) => { const sensor_px = upright.toSensor(pictureOf(shown, frame, point)); if (marking) onMark(sensor_px); else onPick(sensor_px, 1 / shown.scale); },
    key: (event) => marking && cursor !== null && aim(event, cursor, setCursor, () => onMark(upright.toSensor(cursor))),
  };
  useGestures(surface, act);
  const picture = `${path}?width_px=${Math.min(WIDEST_PX, detection.width_px)}&upright=false`;
  const screen = cursor && [(cursor[0] - shown.x_px) * shown.scale + frame.width / 2, (cursor[1] - shown.y_px) * shown.scale + frame.height / 2];
  return html`<div class="photo-frame" style=${{ aspectRatio: `${upright.width_px} / ${upright.height_px}` }}>
    <svg ref=${surface} class=${`photo ${marking ? "marking" : ""} ${shown.scale >= PIXELS_FROM_SCALE ? "squares" : ""}`} viewBox=${viewBoxOf(shown, frame)} tabindex="0" role="application"
      aria-label=${marking ? "Photograph: arrows move the cross, Enter sets the mark, plus and minus zoom" : "Photograph: drag or arrows move it, wheel, pinch, plus and minus zoom, 0 shows all"}>
      <g transform=${upright.transform}><image href=${picture} x="-0.5" y="-0.5" width=${detection.width_px} height=${detection.height_px} /></g>
      <${Overlay} detection=${detection} marks=${marks} upright=${upright} scale=${shown.scale} show=${show} picked=${picked} />
      ${cursor && html`<circle class="cursor" cx=${cursor[0]} cy=${cursor[1]} r=${3 / shown.scale} />`}
    </svg>
    ${cursor && html`<${Loupe} picture=${picture} upright=${upright} sensor=${detection} cursor=${cursor} screen=${screen} frame=${frame} scale=${shown.scale} />`}
    <div class="photo-buttons"><${Button} aria-label="Zoom in" onClick=${() => act.zoom(BUTTON_ZOOM)}>+</${Button}><${Button} aria-label="Zoom out" onClick=${() => act.zoom(1 / BUTTON_ZOOM)}>−</${Button}><${Button} onClick=${act.fit}>All</${Button}></div>
    <p class="photo-scale small number" role="status">${Math.round(100 * shown.scale)} %</p>
  </div>`;
}

/** Keys while something is to be marked; true when it was one of them. Shift moves by whole pixels. */
function aim(event, [x, y], setCursor, onEnter) {
  const step = event.shiftKey ? 1 : KEY_STEP_PX;
  const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  if (event.key === "Enter") onEnter();
  else if (event.key in moves) setCursor([x + moves[event.key][0], y + moves[event.key][1]]);
  else return false;
  event.preventDefault();
  return true;
}

/** The size of an element on the screen, followed as it changes. */
function useFrame(element) {
  const [frame, setFrame] = useState({ width: 800, height: 500 });
  useLayoutEffect(() => {
    const follow = ({ width, height }) => setFrame({ width: width || 1, height: height || 1 });
    const observer = new ResizeObserver(([entry]) => follow(entry.contentRect));
    follow(element.current.getBoundingClientRect());
    observer.observe(element.current);
    return () => observer.disconnect();
  }, []);
  return frame;
}
