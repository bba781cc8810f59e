// A small piece of the photograph, eight times as large, with a cross where a mark would go.
import { html } from "../core/html.js";

const SIZE_SCREEN_PX = 176;
const MAGNIFICATION = 8; // of picture pixels, or of what is seen when that is larger already
const AWAY_SCREEN_PX = 28; // from the finger or pointer

/** @param {{picture: string, upright: any, sensor: {width_px: number, height_px: number}, cursor: number[], screen: number[], frame: {width: number, height: number}, scale: number}} given cursor in upright pixels */
export function Loupe({ picture, upright, sensor, cursor, screen, frame, scale }) {
  const seen = SIZE_SCREEN_PX / Math.max(MAGNIFICATION, 2 * scale);
  const [x, y] = cursor;
  const left = screen[0] + AWAY_SCREEN_PX + SIZE_SCREEN_PX > frame.width ? screen[0] - AWAY_SCREEN_PX - SIZE_SCREEN_PX : screen[0] + AWAY_SCREEN_PX;
  const top = screen[1] - AWAY_SCREEN_PX - SIZE_SCREEN_PX < 0 ? screen[1] + AWAY_SCREEN_PX : screen[1] - AWAY_SCREEN_PX - SIZE_SCREEN_PX;
  return html`<svg class="loupe" aria-hidden="true" width=${SIZE_SCREEN_PX} height=${SIZE_SCREEN_PX} style=${{ left: `${Math.max(0, left)}px`, top: `${top}px` }} viewBox=${`${x - seen / 2} ${y - seen / 2} ${seen} ${seen}`}>
    <g transform=${upright.transform}><image href=${picture} x="-0.5" y="-0.5" width=${sensor.width_px} height=${sensor.height_px} /></g>
    <path d=${`M${x - seen / 2},${y}h${seen * 0.44}m${seen * 0.12},0h${seen * 0.44}M${x},${y - seen / 2}v${seen * 0.44}m0,${seen * 0.12}v${seen * 0.44}`} />
  </svg>`;
}
