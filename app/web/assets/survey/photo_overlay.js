// What a detector saw, drawn over its photograph: targets with their dots, what was refused, what a person marked.
import { html } from "../core/html.js";
import { OUTLINE, isBase } from "./dots.js";

const DOT_SCREEN_PX = 4.5;
const LETTER_SCREEN_PX = 13;
const DOTS_SHOWN_FROM_PX = 12; // screen pixels between dots below which they would only cover the plate
const CODE_SHOWN_FROM_PX = 5; // and below which codes would only cover each other

/** @param {{detection: any, marks: any[], upright: any, scale: number, show: {found: boolean, refused: boolean}, picked: string | null}} given */
export function Overlay({ detection, marks, upright, scale, show, picked }) {
  const at = upright.toUpright;
  return html`<g class="overlay">
    ${show.refused && detection.rejected.map((refused, index) => html`<${Refused} key=${`r${index}`} refused=${refused} at=${at} scale=${scale} picked=${picked === `r${index}`} />`)}
    ${show.found && detection.targets.map((target) => html`<${Target} key=${target.code} target=${target} at=${at} scale=${scale} picked=${picked === `t${target.code}`} />`)}
    ${marks.map((mark) => html`<${Mark} key=${`${mark.code} ${mark.dot}`} mark=${mark} at=${at} scale=${scale} />`)}
  </g>`;
}

function Target({ target, at, scale, picked }) {
  const dots = target.dots_px.map(at);
  const corners = OUTLINE.map((cell) => dots[cell]);
  const pitch = scale * Math.hypot(dots[1][0] - dots[0][0], dots[1][1] - dots[0][1]);
  return html`<g class=${`found ${picked ? "picked" : ""}`}><polygon points=${corners.map((point) => point.join(",")).join(" ")} />
    ${pitch >= DOTS_SHOWN_FROM_PX && dots.map(([x, y], cell) => html`<circle key=${cell} class=${`${isBase(cell) ? "base" : ""} ${target.measured[cell] ? "" : "guessed"}`} cx=${x} cy=${y} r=${DOT_SCREEN_PX / scale} />`)}
    ${(picked || pitch >= CODE_SHOWN_FROM_PX) && html`<${Label} points=${corners} scale=${scale} text=${target.code} />`}</g>`;
}

function Refused({ refused, at, scale, picked }) {
  const points = (refused.corners_px?.length ? refused.corners_px : [refused.centre_px]).map(at);
  const [x, y] = at(refused.centre_px);
  return html`<g class=${`refused ${picked ? "picked" : ""}`}>
    ${points.length > 2 ? html`<polygon points=${hull(points).map((point) => point.join(",")).join(" ")} />` : html`<circle cx=${x} cy=${y} r=${(2 * DOT_SCREEN_PX) / scale} />`}
    ${picked && html`<${Label} points=${points} scale=${scale} text=${refused.reason} />`}</g>`;
}

function Mark({ mark, at, scale }) {
  const [x, y] = at([mark.x_px, mark.y_px]);
  const arm = (2 * DOT_SCREEN_PX) / scale;
  return html`<g class="marked"><path d=${`M${x - arm},${y}h${2 * arm}M${x},${y - arm}v${2 * arm}`} /><${Label} points=${[[x, y - arm / 2]]} scale=${scale} text=${`${mark.code} ${mark.dot}`} /></g>`;
}

const Label = ({ points, scale, text }) => html`<text x=${points.reduce((sum, point) => sum + point[0], 0) / points.length} y=${Math.min(...points.map((point) => point[1])) - 6 / scale}
  font-size=${LETTER_SCREEN_PX / scale} stroke-width=${3 / scale} text-anchor="middle">${text}</text>`;

/** Points in the order of their direction from their middle: as a detector lists them, lines would cross. */
function hull(points) {
  const [x, y] = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  return [...points].sort((a, b) => Math.atan2(a[1] - y, a[0] - x) - Math.atan2(b[1] - y, b[0] - x));
}
