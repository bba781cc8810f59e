// The start of all pages: follow a link, find out who asks, draw the frame.
import { html, render } from "./core/html.js";
import { followLink } from "./core/session.js";
import { Shell } from "./shell.js";

const root = document.getElementById("app");
let linkError = null;
try {
  await followLink();
} catch (error) {
  linkError = error;
}
render(html`<${Shell} linkError=${linkError} />`, root);
