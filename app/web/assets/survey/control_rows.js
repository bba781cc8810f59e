// Control points as rows of text: read from what people paste, checked before they are sent.
import { familyHolds } from "./families.js";

export const COLUMNS = ["name", "code", "dot", "x_m", "y_m", "z_m", "sigma_m", "role"];
const NUMBERS = ["x_m", "y_m", "z_m", "sigma_m"];
const DOT = /^([A-E]|r[0-3]c[0-3]|centre)$/;
const DEFAULTS = { sigma_m: "0.001", role: "control" };
export const LEAST_CONTROL = 3;
export const ADVISED_CONTROL = 4; // one more than needed: a blunder in three points cannot be seen
const LEAST_BREADTH = 1e-3; // as the service has it: extent across the line over extent along it
const ZERO_DIVISION = 1e-12;

export const emptyRow = () => ({ ...Object.fromEntries(COLUMNS.map((name) => [name, ""])), ...DEFAULTS });
export const isEmpty = (row) => COLUMNS.every((name) => (row[name] ?? "") === (DEFAULTS[name] ?? ""));

/**
 * Rows of pasted or dropped text: cells parted by tabs, semicolons or commas, with or without a line of names.
 * @param {string} text
 * @returns {{rows: Array<Record<string, string>>, problems: string[]}} problems of the text as a whole
 */
export function readRows(text) {
  const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\r|\n/).filter((line) => line.trim());
  if (!lines.length) return { rows: [], problems: ["There is no line in it."] };
  const mark = separatorOf(lines[0]);
  const cells = lines.map((line) => cellsOf(line, mark));
  const names = cells[0].map((cell) => cell.toLowerCase());
  const headed = names.includes("name") && names.includes("code");
  const header = headed ? names : COLUMNS;
  const problems = headed ? headerProblems(names) : [];
  const bodies = headed ? cells.slice(1) : cells;
  bodies.forEach((body, index) => { if (body.length > header.length) problems.push(`Line ${index + 1 + headed}: ${body.length} cells where there are ${header.length} columns.`); });
  return { rows: bodies.map((body) => rowOf(body, header, mark)), problems };
}

/** The mark that stands most often in the first line; a spreadsheet's tabs come before all. */
function separatorOf(line) {
  if (line.includes("\t")) return "\t";
  return line.split(";").length >= line.split(",").length ? ";" : ",";
}

/** Cells of a line; what stands in quotes may hold the mark. */
function cellsOf(line, mark) {
  const cells = [""];
  let quoted = false;
  for (const letter of line) {
    if (letter === '"') quoted = !quoted;
    else if (letter === mark && !quoted) cells.push("");
    else cells[cells.length - 1] += letter;
  }
  return cells.map((cell) => cell.trim());
}

function headerProblems(names) {
  const missing = COLUMNS.filter((name) => !names.includes(name) && !(name in DEFAULTS));
  const odd = names.filter((name) => name && !COLUMNS.includes(name));
  return [
    ...(missing.length ? [`The first line names no column ${missing.join(", ")}.`] : []),
    ...(odd.length ? [`Columns not known, left out: ${odd.join(", ")}.`] : []),
  ];
}

function rowOf(cells, header, mark) {
  const row = emptyRow();
  header.forEach((name, index) => {
    const cell = cells[index] ?? "";
    if (COLUMNS.includes(name) && cell !== "") row[name] = NUMBERS.includes(name) && mark !== "," ? cell.replace(/^(-?\d+),(\d+)$/, "$1.$2") : cell;
  });
  return row;
}

/**
 * What is wrong with rows, cell by cell.
 * @param {Array<Record<string, string>>} rows
 * @param {string} family the site's code family
 * @returns {Array<{row: number, column: string, problem: string}>} rows count from 0
 */
export function checkRows(rows, family) {
  const seen = { names: new Map(), dots: new Map() };
  return rows.flatMap((row, index) => [...cellFaults(row, family), ...repeated(row, index, seen)].map((fault) => ({ row: index, ...fault })));
}

function cellFaults(row, family) {
  const faults = COLUMNS.filter((name) => row[name] === "").map((column) => ({ column, problem: "is missing" }));
  const add = (column, wrong, problem) => { if (row[column] !== "" && wrong) faults.push({ column, problem }); };
  NUMBERS.forEach((column) => add(column, !isNumber(row[column]), `"${row[column]}" is no number of metres (write 4.46)`));
  add("sigma_m", isNumber(row.sigma_m) && Number(row.sigma_m) <= 0, "must be greater than 0");
  add("code", !/^\d+$/.test(row.code) || !familyHolds(family, Number(row.code)), `"${row.code}" is no code of the family ${family}`);
  add("dot", !DOT.test(row.dot), `"${row.dot}" is none of A ... E, r0c0 ... r3c3, centre`);
  add("role", !["control", "check"].includes(row.role), `"${row.role}" is neither control nor check`);
  return faults;
}

const isNumber = (text) => text.trim() !== "" && Number.isFinite(Number(text));

function repeated(row, index, seen) {
  const faults = [];
  const look = (kind, key, column, what) => {
    if (seen[kind].has(key)) faults.push({ column, problem: `${what} stands in row ${seen[kind].get(key) + 1} too` });
    else seen[kind].set(key, index);
  };
  if (row.name) look("names", row.name, "name", `"${row.name}"`);
  if (row.code && row.dot) look("dots", `${Number(row.code)} ${row.dot}`, "dot", `dot ${row.dot} of code ${row.code}`);
  return faults;
}

/**
 * Whether the points can carry a frame.
 * @returns {{kind: "good" | "warn" | "bad", text: string}}
 */
export function judgeDatum(rows) {
  const control = rows.filter((row) => row.role === "control" && ["x_m", "y_m", "z_m"].every((name) => isNumber(row[name])));
  if (!rows.length) return { kind: "warn", text: "Without control points the map is free: its scale is that of the print, its axes are assumed." };
  if (control.length < LEAST_CONTROL) return { kind: "bad", text: `${control.length} control points do not fix the frame: ${LEAST_CONTROL} not in one line are needed, ${ADVISED_CONTROL} advised.` };
  if (inLine(control.map((row) => [row.x_m, row.y_m, row.z_m].map(Number)))) return { kind: "bad", text: "The control points are in one line: add one well off it." };
  if (control.length < ADVISED_CONTROL) return { kind: "warn", text: `${control.length} control points fix the frame but show no blunder: give ${ADVISED_CONTROL} or more.` };
  return { kind: "good", text: `${control.length} control points and ${rows.length - control.length} check points.` };
}

/** Whether points lie in one line, by the two greatest eigenvalues of their scatter. */
export function inLine(points) {
  const mean = [0, 1, 2].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  const scatter = [0, 1, 2].map((a) => [0, 1, 2].map((b) => points.reduce((sum, point) => sum + (point[a] - mean[a]) * (point[b] - mean[b]), 0)));
  const trace = scatter[0][0] + scatter[1][1] + scatter[2][2];
  const minors = [[0, 1], [0, 2], [1, 2]].reduce((sum, [a, b]) => sum + scatter[a][a] * scatter[b][b] - scatter[a][b] ** 2, 0);
  // Of eigenvalues l1 >= l2 >= l3 the minors' sum is l1 l2 + l1 l3 + l2 l3, which is about l1 l2 near a line.
  return trace < ZERO_DIVISION || minors / trace ** 2 <= LEAST_BREADTH ** 2;
}

/** A row as the service takes it. */
export const recordOf = (row) => ({ ...row, name: row.name.trim(), code: Number(row.code), ...Object.fromEntries(NUMBERS.map((name) => [name, Number(row[name])])) });
/** A row of what the service gave. */
export const rowOfRecord = (record) => Object.fromEntries(COLUMNS.map((name) => [name, String(record[name])]));
