// The report page's own program, after the one that draws the body.
#include "formats/report_text.h"

namespace palpate {

const char* const report_script = R"js(const nodeName = i32('node');
const tools = info.tools.map((t, k) => ({...t, begin: i32(`begin${k}`), depth: f32(`depth${k}`),
  force: f32(`force${k}`), slope: f32(`slope${k}`), slopeMax: f32(`slopemax${k}`),
  error: f32(`error${k}`), verified: f32(`verified${k}`), origin: bytesOf(`origin${k}`)}));
const origins = ['none', 'simulated', 'interpolated', 'measured'];
const originColour = [[200, 200, 200], [0, 114, 178], [230, 159, 0], [0, 158, 115]];

// Force [N] and slope [N/m] of node i at depth d [m]: the file's own cubic.
function response(tool, i, d) {
  const a = tool.begin[i], b = tool.begin[i + 1], D = tool.depth, F = tool.force, M = tool.slope;
  if (a === b) return null;
  if (d > D[b - 1]) return {force: F[b - 1] + M[b - 1] * (d - D[b - 1]), extrapolated: true};
  let k = a;
  while (k < b - 2 && D[k + 1] < d) ++k;
  const h = D[k + 1] - D[k], x = (d - D[k]) / h, s = (F[k + 1] - F[k]) / h, m = M[k], e = M[k + 1];
  return {force: F[k] + h * x * (m + x * (3 * s - 2 * m - e + x * (m + e - 2 * s))), extrapolated: false};
}

const state = {tool: 0, colour: 'stiffness', depth: 0, node: -1};
const kinds = {
  stiffness: {name: 'stiffness f/d at the depth', unit: 'N/m',
    at: (t, i) => { const r = response(t, i, state.depth); return r ? r.force / state.depth : NaN; }},
  slope: {name: 'largest slope', unit: 'N/m', at: (t, i) => t.begin[i] < t.begin[i + 1] ? t.slopeMax[i] : NaN},
  depth: {name: 'largest depth', unit: 'mm', at: (t, i) => t.begin[i] < t.begin[i + 1] ? 1e3 * t.depth[t.begin[i + 1] - 1] : NaN},
  error: {name: 'estimated error of force', unit: '%', at: (t, i) => t.origin[i] ? 100 * t.error[i] : NaN},
  verified: {name: 'verified error of force', unit: '%', at: (t, i) => t.verified.length ? 100 * t.verified[i] : NaN},
  origin: {name: 'origin', unit: '', at: (t, i) => t.origin[i]},
};
let value = new Float32Array(n), range = [0, 1];

function evaluate() {
  const tool = tools[state.tool], at = kinds[state.colour].at;
  for (let i = 0; i < n; ++i) value[i] = at(tool, i);
  const known = value.filter(Number.isFinite).sort();
  const pick = q => known.length ? known[Math.round(q * (known.length - 1))] : 0;
  let [low, high] = [pick(0.02), pick(0.98)];
  const missing = Math.max(0.1 * Math.abs(high), 1e-9) - (high - low);  // rounding is no colour
  if (missing > 0) { low -= missing / 2; high += missing / 2; }
  range = [low, high];
  drawLegend(known);
  drawCurve();
  redraw();
}
const place = v => (v - range[0]) / (range[1] - range[0]);
function colourOf(a, b, c, wa, wb, wc) {
  if (state.colour === 'origin') return originColour[value[wa > wb ? (wa > wc ? a : c) : (wb > wc ? b : c)]];
  const v = wa * value[a] + wb * value[b] + wc * value[c];
  return Number.isFinite(v) ? table[Math.min(255, Math.max(0, Math.round(255 * place(v))))] : originColour[0];
}
function drawMarks(scale, deep) {
  if (state.node >= 0) {
    const x = corner[3 * state.node], y = corner[3 * state.node + 1], z = corner[3 * state.node + 2];
    const at = Math.round(y) * width + Math.round(x);
    context.globalAlpha = z < deep[at] - 0.03 * radius ? 0.35 : 1;  // behind the body
    for (const [colour, wide] of [['#fff', 5], ['#d00', 2.5]]) {
      context.beginPath();
      context.arc(x, y, 7 * scale, 0, 7);
      context.lineWidth = wide * scale;
      context.strokeStyle = colour;
      context.stroke();
    }
    context.globalAlpha = 1;
  }
}

function ticks(low, high, wanted) {
  const raw = (high - low) / wanted || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= raw * (1 - 1e-9)), list = [];
  for (let k = Math.ceil(low / step - 1e-5); k * step <= high + 1e-5 * step; ++k) list.push(k * step);
  return list;
}
// An empty plot and its scales: x and y from and to, names of the axes.
function plot(id, x, y, xName, yName) {
  const W = 460, H = 250, l = 62, r = 12, t = 12, b = 42;
  const px = v => l + (v - x[0]) / (x[1] - x[0] || 1) * (W - l - r);
  const py = v => H - b - (v - y[0]) / (y[1] - y[0] || 1) * (H - t - b);
  let svg = '';
  for (const v of ticks(x[0], x[1], 6)) svg += `<line class="grid" x1="${px(v)}" x2="${px(v)}" y1="${t}" y2="${H - b}"/><text x="${px(v)}" y="${H - b + 16}" text-anchor="middle">${tell(v)}</text>`;
  for (const v of ticks(y[0], y[1], 5)) svg += `<line class="grid" x1="${l}" x2="${W - r}" y1="${py(v)}" y2="${py(v)}"/><text x="${l - 6}" y="${py(v) + 4}" text-anchor="end">${tell(v)}</text>`;
  svg += `<text x="${(l + W - r) / 2}" y="${H - 6}" text-anchor="middle">${xName}</text>`;
  svg += `<text transform="translate(14 ${(t + H - b) / 2}) rotate(-90)" text-anchor="middle">${yName}</text>`;
  return {px, py, show: inner => { $(id).innerHTML = `<svg viewBox="0 0 ${W} ${H}">${svg}${inner}</svg>`; }};
}

function drawCurve() {
  const tool = tools[state.tool], i = state.node;
  if (i < 0) return;
  const a = tool.begin[i], b = tool.begin[i + 1];
  const where = [0, 1, 2].map(j => tell(1e3 * position[3 * i + j], 4)).join(', ');
  let text = `Node ${nodeName[i]} at (${where}) mm: ${origins[tool.origin[i]]}`;
  if (a === b) {
    $('curve').innerHTML = '<p class="hint">This node has no response.</p>';
    $('said').textContent = text;
    return;
  }
  const end = tool.depth[b - 1], top = Math.max(...tool.force.subarray(a, b)) || 1;
  const p = plot('curve', [0, 1e3 * end], [0, 1.05 * top], 'depth d [mm]', 'force f [N]');
  let path = '', dots = '';
  for (let k = 0; k <= 200; ++k) {
    const d = end * k / 200;
    path += `${k ? 'L' : 'M'}${p.px(1e3 * d).toFixed(1)} ${p.py(response(tool, i, d).force).toFixed(1)}`;
  }
  for (let k = a; k < b; ++k) dots += `<circle cx="${p.px(1e3 * tool.depth[k])}" cy="${p.py(tool.force[k])}" r="2.6"/>`;
  const at = response(tool, i, state.depth), mark = p.px(1e3 * Math.min(state.depth, end));
  p.show(`<line class="mark" x1="${mark}" x2="${mark}" y1="${p.py(0)}" y2="${p.py(1.05 * top)}"/><path class="curve" d="${path}"/>${dots}`);
  text += `, estimated error ${tell(100 * tool.error[i], 2)} %. At ${tell(1e3 * state.depth)} mm: ${tell(at.force)} N, ${tell(at.force / state.depth)} N/m${at.extrapolated ? ' (beyond the last sample)' : ''}.`;
  $('said').textContent = text;
}

function drawLegend(known) {
  const kind = kinds[state.colour], counts = new Array(30).fill(0);
  if (state.colour === 'origin') {
    $('legend').innerHTML = origins.map((name, k) => `<span><i style="background:${css(originColour[k])}"></i>${name}</span>`).join(' ');
  } else {
    const bar = Array.from({length: 11}, (_, i) => css(viridis(i / 10))).join();
    $('legend').innerHTML = `<span>${tell(range[0])}</span><b style="background:linear-gradient(90deg,${bar})"></b><span>${tell(range[1])} ${kind.unit}</span> <span><i style="background:${css(originColour[0])}"></i>none</span>`;
  }
  const tool = tools[state.tool], stiff = [];
  for (let i = 0; i < n; ++i) { const v = kinds.stiffness.at(tool, i); if (Number.isFinite(v)) stiff.push(v); }
  stiff.sort((p, q) => p - q);
  if (!stiff.length) { $('histogram').innerHTML = '<p class="hint">No responses.</p>'; return; }
  const low = stiff[0], high = stiff[stiff.length - 1] > low * (1 + 1e-6) ? stiff[stiff.length - 1] : low + Math.max(1e-9, 0.1 * Math.abs(low));
  for (const v of stiff) ++counts[Math.min(29, Math.floor(30 * (v - low) / (high - low)))];
  const most = Math.max(...counts), p = plot('histogram', [low, high], [0, 1.05 * most], `stiffness f/d at ${tell(1e3 * state.depth)} mm [N/m]`, 'nodes');
  p.show(counts.map((c, k) => {
    const from = low + (high - low) * k / 30, to = low + (high - low) * (k + 1) / 30;
    const colour = state.colour === 'stiffness' ? css(viridis(place((from + to) / 2))) : '#7a8794';
    return `<rect x="${p.px(from) + 0.5}" width="${p.px(to) - p.px(from) - 1}" y="${p.py(c)}" height="${p.py(0) - p.py(c)}" fill="${colour}"><title>${tell(from)} to ${tell(to)} N/m: ${c} nodes</title></rect>`;
  }).join(''));
}
)js";

const char* const report_controls = R"js(
function choose(node) {
  state.node = node;
  drawCurve();
  redraw();
}
const clicked = (x, y) => { const node = nodeAt(x, y); if (node >= 0) choose(node); };
const step = k => choose((state.node + k + n) % n);
const keys = {n: () => step(1), p: () => step(state.node < 0 ? 0 : -1), Enter: () => {
  const box = canvas.getBoundingClientRect();
  clicked(box.left + box.width / 2, box.top + box.height / 2);
}};
function setDepth(d) {
  state.depth = d;
  $('depthsaid').textContent = `${tell(1e3 * d)} mm`;
  evaluate();
}
function setTool(k) {
  state.tool = k;
  const end = tools[k].depth_max_m || 1e-3;
  for (const option of $('colour').options) option.disabled = option.value === 'verified' && !tools[k].verified.length;
  if (state.colour === 'verified' && !tools[k].verified.length) $('colour').value = state.colour = 'stiffness';
  $('depth').value = 50;
  setDepth(end / 2);
}
$('tool').innerHTML = tools.map((t, k) => `<option value="${k}"></option>`).join('');
tools.forEach((t, k) => { $('tool').options[k].textContent = `${t.name}: ${t.description}`; });
$('colour').innerHTML = Object.entries(kinds).map(([key, kind]) => `<option value="${key}">${kind.name}</option>`).join('');
$('tool').addEventListener('change', e => setTool(+e.target.value));
$('colour').addEventListener('change', e => { state.colour = e.target.value; evaluate(); });
$('depth').addEventListener('input', e => setDepth((tools[state.tool].depth_max_m || 1e-3) * e.target.value / 100));
setTool(0);
)js";

}  // namespace palpate
