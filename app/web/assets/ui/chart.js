// uPlot as a part of pages: colours of the page, its width, one cursor and one range with its neighbours.
import uPlot from "/vendor/uplot.min.js";
import { html, useEffect, useLayoutEffect, useRef } from "../core/html.js";
import { colour, useTheme } from "./theme.js";

const FONT_PX = 12;
const LEFT_AXIS_PX = 64; // the same for all, so that charts below each other share their time axis
const TICK_PX = 5;

/**
 * A chart.
 * @param {object} given
 * @param {string} given.label what it shows, for those who do not see it
 * @param {Array<ArrayLike<number | null>>} given.data x, then the series
 * @param {() => object} given.make uPlot's `series`, `bands`, `hooks`, `axes`, `scales`; asked again when `keys` change
 * @param {unknown[]} [given.keys] what `make` rests on
 * @param {number} [given.height_px]
 * @param {{get, set, listen}} [given.pointer] shared row that is pointed at
 * @param {{get, set, listen}} [given.range] shared [least, greatest] of x
 */
export function Chart({ label, data, make, keys = [], height_px = 160, pointer, range }) {
  const place = useRef(null);
  const chart = useRef(null);
  const theme = useTheme();
  useLayoutEffect(() => {
    const made = new uPlot(optionsOf(make(), place.current.clientWidth, height_px, { pointer, range }), data, place.current);
    chart.current = made;
    const ends = [followWidth(made, place.current, height_px), pointer && followPointer(made, pointer), range && followRange(made, range, pointer)];
    return () => { ends.forEach((end) => end?.()); made.destroy(); };
  }, [...keys, theme, height_px]);
  useEffect(() => { if (chart.current.data !== data) chart.current.setData(data, !range?.get()); }, [data]);
  return html`<div class="chart" role="img" aria-label=${label} ref=${place}></div>`;
}

/** A line as a staircase: each value holds until the next. */
export const staircase = uPlot.paths.stepped({ align: 1 });

/** An axis in the page's colours. */
const axis = (more = {}) => ({
  stroke: colour("muted"),
  font: `${FONT_PX}px system-ui, sans-serif`,
  grid: { stroke: colour("line"), width: 1 },
  ticks: { stroke: colour("line"), width: 1, size: TICK_PX },
  ...more,
});

function optionsOf({ axes = [{}, {}], hooks = {}, scales = { x: { time: false } }, ...made }, width, height, shared) {
  const [below, left] = axes;
  return {
    width: Math.max(width, 1),
    height,
    legend: { show: false },
    cursor: { y: false, drag: { x: Boolean(shared.range), y: false, setScale: true }, points: { size: 7 } },
    scales,
    axes: [axis(below), axis({ size: LEFT_AXIS_PX, ...left })],
    hooks: { ...hooks, setCursor: [tellPointer(shared.pointer)], setScale: [tellRange(shared.range)] },
    ...made,
  };
}

const tellPointer = (pointer) => (chart) => {
  if (pointer && chart.cursor.event) pointer.set(chart.cursor.idx ?? null, chart);
};

/** Only what a hand changed: a chart that follows the others tells nothing. */
const tellRange = (range) => (chart, key) => {
  if (!range || key !== "x" || chart.following || !chart.data[0].length) return;
  const { min, max } = chart.scales.x;
  const [first, last] = [chart.data[0][0], chart.data[0].at(-1)];
  const whole = min <= first && max >= last;
  const before = range.get();
  if (whole ? before === null : before?.[0] === min && before?.[1] === max) return;
  range.set(whole ? null : [min, max], chart);
};

function followWidth(chart, place, height) {
  const observer = new ResizeObserver(() => place.clientWidth && place.clientWidth !== chart.width && chart.setSize({ width: place.clientWidth, height }));
  observer.observe(place);
  return () => observer.disconnect();
}

function followPointer(chart, pointer) {
  return pointer.listen((row, by) => by === chart || pointAt(chart, row));
}

function pointAt(chart, row) {
  const x = row === null ? undefined : chart.data[0][row];
  const left = x === undefined ? -1 : chart.valToPos(x, "x");
  chart.setCursor({ left, top: left < 0 ? -1 : 1 }, false);
}

function followRange(chart, range, pointer) {
  const follow = (wanted, by) => {
    const xs = chart.data[0];
    if (by === chart || !xs.length) return;
    chart.following = true;
    chart.batch(() => chart.setScale("x", wanted ? { min: wanted[0], max: wanted[1] } : { min: xs[0], max: xs.at(-1) }));
    chart.following = false;
    if (pointer) pointAt(chart, pointer.get());
  };
  if (range.get()) follow(range.get(), null);
  return range.listen(follow);
}
