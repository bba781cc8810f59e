// The plan of the site with where one is: a dot, its 95 % ellipse, where the camera looks, the way so far.
import { html, useMemo, useRef } from "../core/html.js";
import { drawTargets } from "../plan/draw.js";
import { Plan } from "../plan/plan.js";
import { drawDots, drawWay } from "../plan/track.js";
import { boundsOf, pixelsOf, roundBelow } from "../plan/view.js";
import { gapOf, poseOf } from "../trajectories/poses.js";
import { useShared } from "../ui/shared_value.js";
import { colour } from "../ui/theme.js";
import { ellipseOf } from "./ellipse.js";

const DOT_PX = 6;
const LOOK_PX = 46; // how far the sector of the view reaches
const HALF_VIEW_RAD = 0.45; // as wide as most phones see
const LEAST_ELLIPSE_PX = 14; // of its longer half: millimetres are smaller than a pixel of a plan, so ellipses are enlarged

/** @param {object[]} answers of pictures that were located, oldest first; the last is where one is */
export function HerePlan({ room, answers }) {
  const pointer = useShared();
  const note = useRef(null); // how much the ellipse is enlarged rests on the view
  const poses = useMemo(() => answers.map(poseOf), [answers]);
  const points = useMemo(() => poses.map((pose) => pose.position_m), [poses]);
  const bounds = useMemo(() => boundsOf([...points, ...room.targets.map((target) => target.position_m)]), [points, room]);
  const gap_s = useMemo(() => gapOf(poses), [poses]);
  const [here, answer] = [poses.at(-1), answers.at(-1)];
  const draw = (context, view) => {
    drawTargets(context, view, room.targets, room.plate_u_m);
    drawWay(context, view, points, (index) => poses[index].time_s - poses[index - 1].time_s > gap_s, colour("strong-line"));
    drawDots(context, view, points.slice(0, -1), () => 0, [colour("series-4")]);
    if (!here) return;
    drawLook(context, view, here);
    const enlarged = drawEllipse(context, view, here, ellipseOf(answer.covariance));
    note.current.textContent = `95 % ellipse${enlarged > 1 ? `, ${enlarged.toLocaleString("en")} times enlarged` : ""}; the sector shows where the camera looks.`;
    drawDots(context, view, [here.position_m], () => 0, [colour("accent")], DOT_PX);
  };
  const label = here ? `Plan: the position is x ${here.position_m[0].toFixed(2)}, y ${here.position_m[1].toFixed(2)} m` : "Plan of the site's targets";
  return html`<${Plan} label=${label} bounds=${bounds} draw=${draw} keys=${[answers, room]} points=${points} pointer=${pointer} />
    <p class="small muted phone-note" ref=${note}></p>`;
}

/** A sector towards what the camera sees. */
function drawLook(context, view, { position_m, heading_rad }) {
  if (heading_rad === null) return; // it looks straight up or down
  const [toX, toY] = pixelsOf(view);
  const [x, y] = [toX(position_m[0]), toY(position_m[1])];
  const shade = context.createRadialGradient(x, y, 0, x, y, LOOK_PX);
  shade.addColorStop(0, colour("accent"));
  shade.addColorStop(1, "transparent");
  context.save();
  context.globalAlpha = 0.6;
  context.fillStyle = shade;
  context.beginPath();
  context.moveTo(x, y);
  context.arc(x, y, LOOK_PX, -heading_rad - HALF_VIEW_RAD, -heading_rad + HALF_VIEW_RAD); // the picture's y goes down
  context.fill();
  context.restore();
}

/** @returns {number} how many times it is enlarged */
function drawEllipse(context, view, { position_m }, { major_m, minor_m, turn_rad }) {
  const [toX, toY] = pixelsOf(view);
  const enlarged = enlargement(major_m * view.scale_px_m);
  const scale = enlarged * view.scale_px_m;
  context.strokeStyle = colour("accent");
  context.lineWidth = 2;
  context.beginPath();
  context.ellipse(toX(position_m[0]), toY(position_m[1]), major_m * scale, minor_m * scale, -turn_rad, 0, 2 * Math.PI);
  context.stroke();
  return enlarged;
}

/** The round number of times that makes a length of so many pixels large enough to see. */
const enlargement = (length_px) => (length_px >= LEAST_ELLIPSE_PX ? 1 : roundBelow((2 * LEAST_ELLIPSE_PX) / length_px));
