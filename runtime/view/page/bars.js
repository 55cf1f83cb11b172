// Colour bar, scale bar and the arrow's legend: what turns the picture back into numbers.

import { nice, tell, ticks } from "/figures.js";

const get = (id) => document.getElementById(id);

export function drawColourBar(map) {
  const canvas = get("colours");
  const pen = canvas.getContext("2d");
  const gradient = pen.createLinearGradient(0, canvas.height, 0, 0);
  map.colours.forEach((colour, i) => gradient.addColorStop(i / (map.colours.length - 1), colour));
  pen.fillStyle = gradient;
  pen.fillRect(0, 0, canvas.width, canvas.height);
  const range = map.high_n_per_m - map.low_n_per_m;
  get("colour_ticks").replaceChildren();
  for (const value of ticks(map.low_n_per_m, map.high_n_per_m, 5)) {
    const tick = document.createElement("li");
    tick.textContent = tell(value, 4);
    tick.style.top = `${canvas.height * (1 - (value - map.low_n_per_m) / range)}px`;
    get("colour_ticks").append(tick);
  }
  get("colour_label").textContent = `N/m at ${(map.depth_m * 1e3).toPrecision(2)} mm`;
}

export function drawScaleBar(view) {
  const metres = nice(0.22 * view.viewHeight());
  get("scale_line").style.width = `${(metres / view.viewHeight()) * view.canvas.clientHeight}px`;
  const text = metres >= 0.01 ? `${Number((metres * 100).toPrecision(2))} cm` : `${Number((metres * 1e3).toPrecision(2))} mm`;
  if (get("scale_text").textContent !== text) {
    get("scale_text").textContent = text;
  }
}

// How long an arrow so many newtons make.
export function drawArrowKey(view) {
  const newton = nice((0.1 * view.viewHeight()) / view.metresPerNewton);
  const pixels = ((newton * view.metresPerNewton) / view.viewHeight()) * view.canvas.clientHeight;
  get("arrow_key").style.width = `${pixels}px`;
  const text = `force on the tool, ${Number(newton.toPrecision(1))} N`;
  if (get("arrow_text").textContent !== text) {
    get("arrow_text").textContent = text;
  }
  if (view.contacts) {
    drawTorqueKey(view);
  }
}

function drawTorqueKey(view) {
  const { metresPerNewtonMetre: scale } = view.contacts;
  const torque = nice((0.1 * view.viewHeight()) / scale);
  get("torque_key").style.width = `${((torque * scale) / view.viewHeight()) * view.canvas.clientHeight}px`;
  const text = `torque on the tool, ${Number((1e3 * torque).toPrecision(1))} mN m`;
  if (get("torque_text").textContent !== text) {
    get("torque_text").textContent = text;
  }
}
