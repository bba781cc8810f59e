// The canvas of the room: keeps the stage in step with what the page shows.
import { html, useEffect, useLayoutEffect, useRef } from "../core/html.js";
import { seenWith } from "./load.js";
import { Stage } from "./stage.js";

/** `stageOf.current` is the stage while it stands. */
export function Canvas({ room, poses, axes, scale, visible, view, picked, onPick, onLost, stageOf }) {
  const canvas = useRef(null);
  const pick = useRef(onPick);
  pick.current = onPick;
  useLayoutEffect(() => {
    const element = canvas.current;
    const stage = new Stage(element, (item) => pick.current(item));
    stageOf.current = stage;
    const lost = (event) => { event.preventDefault(); onLost(); };
    element.addEventListener("webglcontextlost", lost);
    return () => { element.removeEventListener("webglcontextlost", lost); stageOf.current = null; stage.dispose(); };
  }, []);
  useEffect(() => stageOf.current.show(room), [room]);
  useEffect(() => stageOf.current.look(view), [room, view]);
  useEffect(() => stageOf.current.showEllipsoids(axes, scale), [axes, scale]);
  useEffect(() => stageOf.current.showPoses(poses), [room, poses]);
  useEffect(() => stageOf.current.showLayers(visible), [room, visible]);
  useEffect(() => stageOf.current.mark(picked, seenWith(room, picked)), [room, picked]);
  return html`<canvas ref=${canvas} class="room-canvas" tabindex="0" role="application" aria-label="Room in three dimensions. Drag to turn, arrow keys to move, click to pick; the same facts stand in the tables below."></canvas>`;
}
