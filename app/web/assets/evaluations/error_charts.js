// How large errors are: their distribution with the usual shares, and their course over time.
import { html, useMemo } from "../core/html.js";
import { Chart, staircase } from "../ui/chart.js";
import { colour, seriesColour } from "../ui/theme.js";
import { distribution, joined, SIZES } from "./systems.js";

const SHARES = [0.5, 0.75, 0.95];
const HEIGHT_PX = 440;
const TIME_PX = 220;
const YEAR_S = 3.15e7; // stamps below count from a start of their own
const AXIS = { labelSize: 18, labelFont: "12px system-ui, sans-serif", size: 46 };

/** The share of pairs whose error is no larger, for each size. */
export function Distribution({ systems, size }) {
  const data = useMemo(() => joined(systems.map((system) => {
    const { sizes_m, shares } = distribution(system.pairs.map((pair) => SIZES[size].of(pair.error_m)));
    return { xs: [0, ...sizes_m], ys: [0, ...shares] };
  })), [systems, size]);
  const make = () => ({
    axes: [{ label: `error ${SIZES[size].label}, m`, ...AXIS, size: 30 }, { ...AXIS, label: "share of pairs", values: (_, ticks) => ticks.map((tick) => `${Math.round(100 * tick)} %`) }],
    scales: { x: { time: false, range: (_, low, high) => [0, high || 1] }, y: { range: [0, 1.02] } },
    series: [{}, ...systems.map((system) => ({ label: system.name, stroke: seriesColour(system.index), width: 2, points: { show: false }, spanGaps: true, paths: staircase }))],
    hooks: { draw: [(chart) => drawShares(chart)] },
    padding: [8, 16, 0, 0],
  });
  return html`<${Chart} label=${`Distribution of errors ${SIZES[size].label}`} data=${data} make=${make} keys=${[systems, size]} height_px=${HEIGHT_PX} />`;
}

function drawShares({ ctx: context, bbox, valToPos }) {
  context.save();
  context.strokeStyle = context.fillStyle = colour("muted");
  context.lineWidth = devicePixelRatio;
  context.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
  context.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  context.textAlign = "right"; // below the lines' ends, where curves are above them
  context.textBaseline = "top";
  for (const share of SHARES) {
    const y = Math.round(valToPos(share, "y", true)) + 0.5;
    context.beginPath();
    context.moveTo(bbox.left, y);
    context.lineTo(bbox.left + bbox.width, y);
    context.stroke();
    context.fillText(`${100 * share} %`, bbox.left + bbox.width - 4 * devicePixelRatio, y + 2 * devicePixelRatio);
  }
  context.restore();
}

/** The error over time, one line for each system. */
export function OverTime({ systems, size, range }) {
  const data = useMemo(() => joined(systems.map((system) => ({ xs: system.pairs.map((pair) => pair.time_s), ys: system.pairs.map((pair) => SIZES[size].of(pair.error_m)) }))), [systems, size]);
  const make = () => ({
    axes: [{}, { ...AXIS, label: `error ${SIZES[size].label}, m` }],
    scales: { x: { time: (data[0][0] ?? 0) > YEAR_S }, y: { range: (_, low, high) => [0, high || 1] } },
    series: [{}, ...systems.map((system) => ({ label: system.name, stroke: seriesColour(system.index), width: 1.25, points: { show: data[0].length < 200, size: 4 }, spanGaps: true }))],
    padding: [8, 16, 0, 0],
  });
  return html`<${Chart} label=${`Error ${SIZES[size].label} over time`} data=${data} make=${make} keys=${[systems, size]} height_px=${TIME_PX} range=${range} />`;
}
