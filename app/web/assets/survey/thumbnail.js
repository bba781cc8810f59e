// A small picture of a photograph. A full server answers "later": the picture is asked for again, ever more seldom.
import { html, useEffect, useRef, useState } from "../core/html.js";

export const THUMBNAIL_PX = 320;
const FIRST_PAUSE_MS = 1000;
const MOST_TRIES = 8; // the last after four minutes: by then the photograph itself is at fault

export function Thumbnail({ surveyId, name }) {
  const [tries, setTries] = useState(0);
  const timer = useRef(0);
  useEffect(() => () => clearTimeout(timer.current), []);
  const again = () => { if (tries < MOST_TRIES) timer.current = setTimeout(() => setTries(tries + 1), FIRST_PAUSE_MS * 2 ** tries); };
  const path = `/surveys/${surveyId}/images/${encodeURIComponent(name)}?width_px=${THUMBNAIL_PX}`;
  return html`<img key=${tries} loading="lazy" decoding="async" alt="" width=${THUMBNAIL_PX} height=${Math.round((THUMBNAIL_PX * 3) / 4)} src=${path} onError=${again} />`;
}
