// The one place that knows which library draws the pages.
export * from "/vendor/preact.min.js";
