// Contrast of what inputs and buttons are known by against what lies behind them, and of the ring that shows the focus.
() => {
  const rgba = (text) => { const [r, g, b, a = 1] = text.match(/[\d.]+/g).map(Number); return [r, g, b, a]; };
  const over = ([r, g, b, a], below) => [r, g, b].map((value, channel) => a * value + (1 - a) * below[channel]);
  const behind = (element) => {
    const layers = [];
    for (let at = element; at; at = at.parentElement) layers.push(rgba(getComputedStyle(at).backgroundColor));
    return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255]);
  };
  const light = (colour) => colour.map((value) => { const part = value / 255; return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4; })
    .reduce((sum, part, channel) => sum + part * [0.2126, 0.7152, 0.0722][channel], 0);
  const contrast = (one, other) => { const [low, high] = [light(one), light(other)].sort((a, b) => a - b); return (high + 0.05) / (low + 0.05); };
  const ringAt = (place) => {
    const probe = place.appendChild(document.createElement("i"));
    probe.style.color = "var(--ring)";
    const found = rgba(getComputedStyle(probe).color);
    probe.remove();
    return found;
  };
  const parts = [...document.querySelectorAll("input, select, textarea, .button")].filter((element) => element.checkVisibility({ opacityProperty: true, visibilityProperty: true })
    && !element.disabled && !["checkbox", "radio", "range", "file"].includes(element.type) && !element.matches(".button.plain"));
  return parts.map((element) => {
    const [style, below] = [getComputedStyle(element), behind(element.parentElement)];
    const border = over(rgba(style.borderTopColor), below);
    const known = style.borderTopWidth === "0px" ? 0 : Math.max(contrast(border, below), contrast(behind(element), below));
    return { what: element.outerHTML.slice(0, 120), known, focus: contrast(over(ringAt(element.parentElement), below), below) };
  });
}
