// Errors seen from above: at each place of the reference an arrow to where the system said it was.
import { html, useMemo } from "../core/html.js";
import { mm, time } from "../core/format.js";
import { drawTargets } from "../plan/draw.js";
import { Plan } from "../plan/plan.js";
import { ShadeLegend, SHADES, shades, shadeScale } from "../plan/shades.js";
import { drawDots, drawWay } from "../plan/track.js";
import { boundsOf, pixelsOf } from "../plan/view.js";
import { useValueOf } from "../ui/shared_value.js";
import { colour, seriesColour } from "../ui/theme.js";
import { SIZES } from "./systems.js";

const ARROW_DOT_PX = 2;
const LEAST_ARROW_PX = 0.5; // a shorter one is not seen
const GAP_S = 3; // no way is drawn across a longer one

/**
 * @param {object} given
 * @param {Array<{name: string, index: number, pairs: object[]}>} given.systems those that are shown
 * @param {"system" | "error"} given.by what colours tell
 * @param {number} given.times how much longer than true errors are drawn
 */
export function ErrorPlan({ systems, size, by, times, room, pointer }) {
  const pairs = useMemo(() => systems.flatMap((system) => system.pairs.map((pair) => ({ ...pair, index: system.index }))), [systems]);
  const ends = useMemo(() => pairs.map(({ reference_m, error_m }) => [0, 1].map((axis) => reference_m[axis] + times * error_m[axis])), [pairs, times]);
  const way = systems[0]?.pairs ?? [];
  const bounds = useMemo(() => boundsOf([...pairs.map((pair) => pair.reference_m), ...ends, ...room.targets.map((target) => target.position_m)]), [pairs, ends, room]);
  const sizes = useMemo(() => pairs.map((pair) => SIZES[size].of(pair.error_m)), [pairs, size]);
  const scale = useMemo(() => shadeScale(sizes), [sizes]);
  const draw = (context, view) => {
    const colours = by === "error" ? shades(SHADES) : systems.map((system) => seriesColour(system.index));
    const places = new Map(systems.map((system, place) => [system.index, place]));
    const shadeOf = (index) => (by === "error" ? scale.place(sizes[index]) : places.get(pairs[index].index));
    drawTargets(context, view, room.targets, room.plate_u_m);
    drawWay(context, view, way.map((pair) => pair.reference_m), (index) => way[index].time_s - way[index - 1].time_s > GAP_S, colour("strong-line"), 1.5);
    drawArrows(context, view, pairs, ends, shadeOf, colours);
    drawDots(context, view, ends, shadeOf, colours, ARROW_DOT_PX);
  };
  return html`<${Plan} label=${`Plan of ${pairs.length} errors of ${systems.map((system) => system.name).join(", ")}`} bounds=${bounds} draw=${draw} keys=${[pairs, size, by, times, room]} points=${ends} pointer=${pointer} />
    <${Readout} pairs=${pairs} systems=${systems} pointer=${pointer} />
    ${by === "error" && scale.known && html`<${ShadeLegend} name=${`Error ${SIZES[size].label}`} low=${mm(scale.low)} high=${mm(scale.high)} />`}`;
}

/** The error that is pointed at. */
function Readout({ pairs, systems, pointer }) {
  const pair = pairs[useValueOf(pointer) ?? -1];
  const name = pair && systems.find((system) => system.index === pair.index)?.name;
  return html`<p class="error-readout small" aria-live="polite">${pair ? html`<b>${name}</b>, ${time(new Date(pair.time_s * 1000).toISOString())}: <span class="number">${mm(Math.hypot(...pair.error_m))}</span> in space (${pair.error_m.map((value) => mm(value)).join(", ")})` : html`<span class="muted">Point at the end of an arrow, or go with the arrow keys from pair to pair.</span>`}</p>`;
}

function drawArrows(context, view, pairs, ends, shadeOf, colours) {
  const [toX, toY] = pixelsOf(view);
  const paths = colours.map(() => new Path2D());
  pairs.forEach(({ reference_m: [x_m, y_m] }, index) => {
    const [from, to] = [[toX(x_m), toY(y_m)], [toX(ends[index][0]), toY(ends[index][1])]];
    if (Math.hypot(to[0] - from[0], to[1] - from[1]) < LEAST_ARROW_PX) return;
    paths[shadeOf(index)].moveTo(...from);
    paths[shadeOf(index)].lineTo(...to);
  });
  context.lineWidth = 1;
  paths.forEach((path, shade) => { context.strokeStyle = colours[shade]; context.stroke(path); });
}
