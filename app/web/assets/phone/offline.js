// Whether this page can be opened without a network: a service worker keeps the pages' files.
import { useEffect, useState } from "../core/html.js";

/** @returns {"asking" | "kept" | "unsupported" | "refused"} refused: browsers keep nothing of a service whose certificate they only tolerate */
export function useKeptPages() {
  const [state, setState] = useState("serviceWorker" in navigator ? "asking" : "unsupported");
  useEffect(() => {
    if (state === "unsupported") return;
    navigator.serviceWorker.register("/sw.js").then(() => navigator.serviceWorker.ready).then(() => setState("kept"), () => setState("refused"));
  }, []);
  return state;
}

export const KEPT_TEXT = {
  asking: "being kept …",
  kept: "yes: pictures queue until the network is back",
  unsupported: "no: this browser keeps pages of secure addresses (https) only",
  refused: "no: the phone does not trust the service's certificate; pictures queue while this page stays open",
};
