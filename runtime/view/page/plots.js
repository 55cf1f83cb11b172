// Plots of what the fast process did, and of a node's curve.
import { uPlot } from "/vendor.min.js";
import { Plot } from "/figures.js";

export const kWindowS = 8;
const kPoints = 1600;

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function axis(extra) {
  return {
    stroke: colour("dim"), font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif",
    grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("line"), width: 1, size: 4 },
    ...extra,
  };
}

export function titled(parent, title) {
  const box = document.createElement("div");
  box.className = "plot";
  const heading = document.createElement("h3");
  heading.textContent = title;
  box.append(heading);
  parent.append(box);
  return box;
}

// From zero, and never a range that makes noise look like a signal.
function fromZero(least) {
  return (_, low, high) => [0, Math.max(least, 1.08 * (high ?? 0))];
}

const kEnergy = { title: "Stored energy, tank [mJ]", keys: ["stored_j", "tank_j"], colours: ["energy", "tank"], scale: 1e3, least: 0.05 };

// Of several contacts or two hands.
export function handRows(hands) {
  const each = (what) => hands.map((_, i) => `${what}${i + 1}`);
  const names = hands.length > 1 ? `, ${hands.map((hand) => hand.name).join(", ")}` : "";
  const torque = { title: `Torque [mN m]${names}`, keys: each("torque").map((key) => `${key}_n_m`), colours: ["torque", "force2"].slice(0, hands.length), scale: 1e3, least: 0.05 };
  return [
    { title: `Force [N]${names}`, keys: each("force").map((key) => `${key}_n`), colours: ["force", "force2"].slice(0, hands.length), scale: 1, least: 0.05 },
    ...(hands.some(({ spheres }) => spheres.length > 1) ? [torque] : []),
    { title: "Deepest contact [mm]", keys: ["depth_m"], colours: ["depth"], scale: 1e3, least: 0.5 },
    kEnergy,
  ];
}

const kRows = [
  { title: "Force [N]", keys: ["force_n"], colours: ["force"], scale: 1, least: 0.05 },
  { title: "Depth [mm]", keys: ["depth_m"], colours: ["depth"], scale: 1e3, least: 0.5 },
  { title: "Stored energy, tank, dents [mJ]", keys: ["stored_j", "tank_j", "memory_j"], colours: ["energy", "tank", "memory"], scale: 1e3, least: 0.05 },
];

export class TickPlots {
  constructor(parent, history, rows = kRows) {
    this.parent = parent;
    this.history = history;
    this.rows = rows;
    this.build();
  }

  build() {
    this.parent.replaceChildren();
    const width = Math.max(240, this.parent.clientWidth - 2);
    const last = this.rows.length - 1;
    this.plots = this.rows.map((row, i) => new uPlot({
      width, height: i === last ? 106 : 82, legend: { show: false }, cursor: { show: false },
      padding: [6, 6, 0, 0],
      scales: { x: { time: false }, y: { range: fromZero(row.least) } },
      axes: [axis({ size: i === last ? 26 : 8, values: i === last ? (_, v) => v.map((s) => `${s} s`) : () => [] }),
             axis({ size: 46, space: 22 })],
      series: [{}, ...row.colours.map((name) => ({ stroke: colour(name), width: 1.4, points: { show: false } }))],
    }, [[], ...row.keys.map(() => [])], titled(this.parent, row.title)));
  }

  draw() {
    this.plots.forEach((plot, i) => {
      const row = this.rows[i];
      const [time, ...values] = this.history.recent(kWindowS, kPoints, ["time_s", ...row.keys]);
      const end = time.length > 0 ? time[time.length - 1] : 0;
      plot.batch(() => {
        plot.setData([time, ...values.map((list) => list.map((v) => v * row.scale))], false);
        plot.setScale("x", { min: Math.max(0, end - kWindowS), max: Math.max(kWindowS, end) });
        plot.setScale("y", { min: null, max: null });
      });
    });
  }
}

// A node's curve with its error band, its samples, and where the tool is now.
export class CurvePlot {
  constructor(parent) {
    this.parent = parent;
  }

  show(curve) {
    this.plot = null;
    this.parent.replaceChildren();
    if (curve.depth_m.length === 0) {
      return;
    }
    const points = (depth, force) => depth.map((d, i) => [d * 1e3, force[i]]);
    const most = Math.max(1e-3, ...curve.force_n, ...curve.sample_force_n) * (1 + Math.min(0.5, curve.error_relative));
    this.plot = new Plot(this.parent, {
      width: Math.max(240, this.parent.clientWidth - 2), height: 170,
      x: [0, curve.depth_m.at(-1) * 1e3], y: [0, 1.05 * most], xName: "depth [mm]", yName: "force [N]" });
    this.plot.curve(points(curve.depth_m, curve.force_n), curve.error_relative, points(curve.sample_depth_m, curve.sample_force_n));
    this.mark = this.plot.add("circle", { class: "now", r: 4.5, visibility: "hidden" });
  }

  // The tool now [mm, N]; off the curve's node it lies beside the curve.
  at(depth_mm, force_n) {
    if (this.plot) {
      this.mark.setAttribute("visibility", depth_mm > 0 ? "visible" : "hidden");
      this.mark.setAttribute("cx", this.plot.px(depth_mm));
      this.mark.setAttribute("cy", this.plot.py(force_n));
    }
  }
}
