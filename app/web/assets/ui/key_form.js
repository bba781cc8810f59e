// Where a key is shown once; the browser keeps a cookie instead of it.
import { useAction } from "../core/hooks.js";
import { html, useState } from "../core/html.js";
import { showKey } from "../core/session.js";
import { Button, Failure, Field } from "./parts.js";

export function KeyForm({ onOpened }) {
  const [key, setKey] = useState("");
  const opening = useAction(async () => { await showKey(key.trim()); onOpened(); });
  return html`<form class="card stack" style=${{ maxWidth: "34rem" }} onSubmit=${(event) => { event.preventDefault(); opening.run(); }}>
    <h1>Key needed</h1>
    <p>This service asks who you are. Paste the key that its operator gave you; this browser stays signed in for some hours and does not keep the key.</p>
    <${Failure} error=${opening.error} />
    <${Field} label="Key"><input type="password" autocomplete="off" required value=${key} onInput=${(event) => setKey(event.target.value)} /></${Field}>
    <div><${Button} type="submit" kind="primary" busy=${opening.busy}>Sign in</${Button}></div>
  </form>`;
}
