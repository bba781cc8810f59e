// Alerts on the plan: whose targets they are, which way the picked one moved, and from where that was seen.
import { html, useMemo } from "../core/html.js";
import { drawTargets } from "../plan/draw.js";
import { Plan } from "../plan/plan.js";
import { drawDots } from "../plan/track.js";
import { boundsOf, pixelsOf } from "../plan/view.js";
import { colour } from "../ui/theme.js";

const RING_PX = 9;
const ARROW_PX = 60; // the picked target's movement: its direction is seen, its length stands in the text
const HEAD_PX = 8;
const HEAD_RAD = 0.5;
const PLACE_PX = 3.5;
const SHADES = { critical: "bad", warning: "warn", notice: "accent" };

/**
 * @param {object} given
 * @param {object[]} given.alerts those that are shown
 * @param {object | null} given.picked one of them
 * @param {object[]} given.sightings of the picked one
 * @param {{get, set, listen}} given.pointer shared index among the alerts that have a place
 */
export function AlertPlan({ room, alerts, picked, sightings, pointer }) {
  const places = useMemo(() => new Map(room.targets.map((target) => [target.code, target.position_m])), [room]);
  const placed = placedOf(alerts, room);
  const cameras = sightings.map((sighting) => sighting.camera_m);
  const bounds = useMemo(() => boundsOf([...room.targets.map((target) => target.position_m), ...cameras]), [room, sightings]);
  const draw = (context, view) => {
    drawTargets(context, view, room.targets, room.plate_u_m);
    drawDots(context, view, cameras, () => 0, [colour("photo")], PLACE_PX);
    for (const alert of placed) ring(context, view, places.get(alert.code), colour(SHADES[alert.severity]), alert === picked);
    if (picked?.displacement && places.has(picked.code)) arrow(context, view, places.get(picked.code), picked.displacement.vector_mm, colour(SHADES[picked.severity]));
  };
  return html`<${Plan} label=${`Plan of ${placed.length} alerts`} bounds=${bounds} draw=${draw} keys=${[alerts, picked, sightings, room]} points=${placed.map((alert) => places.get(alert.code))} pointer=${pointer} />
    <p class="small muted plan-key"><span class="key-ring" aria-hidden="true"></span> alert ${cameras.length > 0 && html`<span class="key-camera" aria-hidden="true"></span> seen from here`} ${picked?.displacement && html`<span class="key-arrow" aria-hidden="true">→</span> which way it moved`}</p>`;
}

/** The alerts whose target the map holds. */
export function placedOf(alerts, room) {
  const codes = new Set(room.targets.map((target) => target.code));
  return alerts.filter((alert) => codes.has(alert.code));
}

function ring(context, view, [x_m, y_m], stroke, strong) {
  const [toX, toY] = pixelsOf(view);
  context.strokeStyle = stroke;
  context.lineWidth = strong ? 3.5 : 2;
  context.beginPath();
  context.arc(toX(x_m), toY(y_m), RING_PX, 0, 2 * Math.PI);
  context.stroke();
}

/** Which way, seen from above; what went straight up or down has a short one. */
function arrow(context, view, [x_m, y_m], vector_mm, stroke) {
  const [toX, toY] = pixelsOf(view);
  const length_mm = Math.hypot(...vector_mm);
  const [dx, dy] = [(ARROW_PX * vector_mm[0]) / length_mm, (-ARROW_PX * vector_mm[1]) / length_mm];
  const [x, y] = [toX(x_m), toY(y_m)];
  const angle = Math.atan2(dy, dx);
  context.strokeStyle = stroke;
  context.lineWidth = 3;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + dx, y + dy);
  for (const side of [-1, 1]) { context.moveTo(x + dx, y + dy); context.lineTo(x + dx - HEAD_PX * Math.cos(angle + side * HEAD_RAD), y + dy - HEAD_PX * Math.sin(angle + side * HEAD_RAD)); }
  context.stroke();
}
