// Colours for what is drawn by hand: canvases know no style sheet.
import { useEffect, useState } from "../core/html.js";

/** A colour of style/tokens.css by its name there: `colour("accent")`. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** A number that changes when the page turns light or dark: what is drawn by hand is drawn anew. */
export function useTheme() {
  const [turn, setTurn] = useState(0);
  useEffect(() => {
    const change = () => setTurn((before) => before + 1);
    const device = matchMedia("(prefers-color-scheme: dark)");
    const chosen = new MutationObserver(change);
    chosen.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
    device.addEventListener("change", change);
    return () => { chosen.disconnect(); device.removeEventListener("change", change); };
  }, []);
  return turn;
}

/** The colour of the n-th of several series; six are told apart. */
export const seriesColour = (index) => colour(`series-${(index % 6) + 1}`);
