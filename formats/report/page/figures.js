// What the live view and the reports draw alike: colours, round numbers, plots of curves.
// A report has the text of this file in its one script, without the word "export".

// The colour [0, 255] at t in [0, 1] between stops like "#440154".
export function colourRamp(stops) {
  const list = stops.map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));
  return (t) => {
    const at = Math.min(Math.max(t, 0), 1) * (list.length - 1);
    const i = Math.min(list.length - 2, Math.floor(at));
    return list[i].map((c, k) => c + (at - i) * (list[i + 1][k] - c));
  };
}

export function css(colour) {
  return `rgb(${colour.map(Math.round).join()})`;
}

// A number in few digits.
export function tell(x, digits = 3) {
  return Number.isFinite(x) ? String(+x.toPrecision(digits)) : "–";
}

// 1, 2 or 5 times a power of ten, at most `most`.
export function nice(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return (most / power >= 5 ? 5 : most / power >= 2 ? 2 : 1) * power;
}

// Round numbers from low to high, at most about `wanted`.
export function ticks(low, high, wanted) {
  const raw = (high - low) / wanted || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw * (1 - 1e-9)), list = [];
  for (let k = Math.ceil(low / step - 1e-5); k * step <= high + 1e-5 * step; ++k) {
    list.push(k * step);
  }
  return list;
}

// 1, 2 and 5 times the powers of ten from low to high, both above zero.
export function logTicks(low, high) {
  const list = [];
  for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); ++k) {
    list.push(...[1, 2, 5].map((step) => step * 10 ** k).filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9)));
  }
  return list;
}

// Where a value lies between two places.
function scale([low, high], from, to, log) {
  const of = log ? Math.log10 : (v) => v;
  return (v) => from + ((of(v) - of(low)) / (of(high) - of(low) || 1)) * (to - from);
}

// A plot with its axes in place of what `parent` holds; x and y are [from, to], along a
// logarithmic axis above zero. Colours are the style sheet's: .grid, .curve, .band,
// .mark, circle, text.
export class Plot {
  constructor(parent, { width, height, x, y, xName, yName, xLog = false, yLog = false }) {
    const [left, right, top, bottom] = [62, width - 20, 12, height - 42];
    this.px = scale(x, left, right, xLog);
    this.py = scale(y, bottom, top, yLog);
    this.inside = (v) => Math.min(y[1], Math.max(y[0], v));
    parent.innerHTML = "<svg></svg>";  // the parser knows SVG's name space
    this.svg = parent.firstChild;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    for (const v of xLog ? logTicks(...x) : ticks(x[0], x[1], width / 75)) {
      this.add("line", { class: "grid", x1: this.px(v), x2: this.px(v), y1: top, y2: bottom });
      this.add("text", { x: this.px(v), y: bottom + 16, "text-anchor": "middle" }, tell(v));
    }
    for (const v of yLog ? logTicks(...y) : ticks(y[0], y[1], height / 50)) {
      this.add("line", { class: "grid", x1: left, x2: right, y1: this.py(v), y2: this.py(v) });
      this.add("text", { x: left - 6, y: this.py(v) + 4, "text-anchor": "end" }, tell(v));
    }
    this.add("text", { x: (left + right) / 2, y: height - 6, "text-anchor": "middle" }, xName);
    this.add("text", { transform: `translate(14 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, yName);
  }

  add(tag, attributes, text = "") {
    const part = document.createElementNS(this.svg.namespaceURI, tag);
    Object.entries(attributes).forEach(([name, value]) => part.setAttribute(name, value));
    part.textContent = text;
    this.svg.append(part);
    return part;
  }

  // "M1 2L3 4" of points [x, y].
  path(points) {
    return points.map(([x, y], i) => `${i ? "L" : "M"}${this.px(x).toFixed(1)} ${this.py(y).toFixed(1)}`).join("");
  }

  // A curve with the band of its relative error and its samples; points are [x, y].
  curve(points, errorRelative, samples) {
    const edge = (sign) => points.map(([x, y]) => [x, this.inside(y * (1 + sign * errorRelative))]);
    this.add("path", { class: "band", d: `${this.path([...edge(1), ...edge(-1).reverse()])}Z` });
    this.add("path", { class: "curve", d: this.path(points) });
    samples.forEach(([x, y]) => this.add("circle", { cx: this.px(x), cy: this.py(y), r: 2.6 }));
  }
}
