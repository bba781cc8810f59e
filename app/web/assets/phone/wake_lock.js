// The screen stays on while pictures are taken, where the browser can do that.
import { useEffect } from "../core/html.js";

export function useWakeLock(wanted) {
  useEffect(() => {
    if (!wanted || !navigator.wakeLock) return undefined;
    let [lock, over] = [null, false];
    // The browser lets go whenever the page is hidden, and refuses when the battery is low: then the screen may go dark.
    const ask = () => document.hidden || navigator.wakeLock.request("screen").then((got) => { over ? got.release() : (lock = got); }, () => {});
    ask();
    document.addEventListener("visibilitychange", ask);
    return () => { over = true; document.removeEventListener("visibilitychange", ask); lock?.release(); };
  }, [wanted]);
}
