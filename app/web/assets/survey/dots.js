// The plate's dots by name (app/targets/layout.py): A ... E are the red ones, the others go by row and column.
const BASE_CELLS = [0, 3, 15, 12, 5];
const SIDE = 4;

export const isBase = (cell) => BASE_CELLS.includes(cell);
export const dotName = (cell) => (isBase(cell) ? "ABCDE"[BASE_CELLS.indexOf(cell)] : `r${Math.floor(cell / SIDE)}c${cell % SIDE}`);
/** All dots, the red ones first: they are the easiest to tell. */
export const DOTS = [...BASE_CELLS, ...Array.from({ length: SIDE * SIDE }, (_, cell) => cell).filter((cell) => !isBase(cell))].map(dotName);
/** The four outer red dots, in the order of the plate's outline. */
export const OUTLINE = BASE_CELLS.slice(0, 4);
