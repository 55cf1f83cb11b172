// Plots of what the fast process did, and of a node's curve.
import { uPlot } from "/vendor.min.js";

const kWindowS = 8;
const kPoints = 1600;

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function axis(extra) {
  return {
    stroke: colour("dim"), font: "11px system-ui, sans-serif", labelFont: "11px system-ui, sans-serif",
    grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("line"), width: 1, size: 4 },
    ...extra,
  };
}

function titled(parent, title) {
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

const kRows = [
  { title: "Force [N]", keys: ["force_n"], colours: ["force"], scale: 1, least: 0.05 },
  { title: "Depth [mm]", keys: ["depth_m"], colours: ["depth"], scale: 1e3, least: 0.5 },
  { title: "Stored energy and tank [mJ]", keys: ["stored_j", "tank_j"], colours: ["energy", "tank"], scale: 1e3, least: 0.05 },
];

export class TickPlots {
  constructor(parent, history) {
    this.parent = parent;
    this.history = history;
    this.build();
  }

  build() {
    this.parent.replaceChildren();
    const width = Math.max(240, this.parent.clientWidth - 2);
    this.plots = kRows.map((row, i) => new uPlot({
      width, height: i === kRows.length - 1 ? 106 : 82, legend: { show: false }, cursor: { show: false },
      padding: [6, 6, 0, 0],
      scales: { x: { time: false }, y: { range: fromZero(row.least) } },
      axes: [axis({ size: i === kRows.length - 1 ? 26 : 8, values: i === kRows.length - 1 ? (_, v) => v.map((s) => `${s} s`) : () => [] }),
             axis({ size: 46, space: 22 })],
      series: [{}, ...row.colours.map((name) => ({ stroke: colour(name), width: 1.4, points: { show: false } }))],
    }, [[], ...row.keys.map(() => [])], titled(this.parent, row.title)));
  }

  draw() {
    this.plots.forEach((plot, i) => {
      const row = kRows[i];
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
    this.curve = null;
  }

  show(curve) {
    this.curve = curve;
    this.now = null;
    this.parent.replaceChildren();
    if (curve.depth_m.length === 0) {
      return;
    }
    const band = (sign) => curve.force_n.map((f) => f * (1 + sign * curve.error_relative));
    const plot = {
      width: Math.max(240, this.parent.clientWidth - 2), height: 150, legend: { show: false }, cursor: { show: false },
      padding: [8, 10, 0, 0],
      scales: { x: { time: false, range: (_, low, high) => [0, high] }, y: { range: fromZero(1e-3) } },
      axes: [axis({ size: 36, label: "depth [mm]", labelSize: 14 }), axis({ size: 46, label: "force [N]", labelSize: 14, space: 24 })],
      series: [{}, { width: 0, stroke: "transparent", points: { show: false } }, { width: 0, stroke: "transparent", points: { show: false } },
               { stroke: colour("force"), width: 2, points: { show: false } }],
      bands: [{ series: [1, 2], fill: colour("force") + "40" }],
      hooks: { draw: [(u) => this.marks(u)] },
    };
    this.plot = new uPlot(plot, [curve.depth_m.map((d) => d * 1e3), band(1), band(-1), curve.force_n], this.parent);
  }

  marks(u) {
    const dot = (x, y, radius, fill) => {
      u.ctx.beginPath();
      u.ctx.arc(u.valToPos(x, "x", true), u.valToPos(y, "y", true), radius * devicePixelRatio, 0, 2 * Math.PI);
      u.ctx.fillStyle = fill;
      u.ctx.fill();
    };
    const { sample_depth_m: depth, sample_force_n: force } = this.curve;
    depth.forEach((d, i) => dot(d * 1e3, force[i], 1.8, colour("text")));
    if (this.now) {
      dot(this.now[0], this.now[1], 4.5, colour("hand"));
    }
  }

  // The tool now [mm, N]; off the curve's node it lies beside the curve.
  at(depth_mm, force_n) {
    if (this.plot && this.curve && (this.now?.[0] !== depth_mm || this.now?.[1] !== force_n)) {
      this.now = depth_mm > 0 ? [depth_mm, force_n] : null;
      this.plot.redraw(false);
    }
  }
}
