// The report page's own script, after figures.js and turnable.js.
const nodeName = i32('node');
const tools = info.tools.map((t, k) => ({...t, begin: i32(`begin${k}`), depth: f32(`depth${k}`),
  force: f32(`force${k}`), slope: f32(`slope${k}`), slopeMax: f32(`slopemax${k}`),
  error: f32(`error${k}`), verified: f32(`verified${k}`), origin: bytesOf(`origin${k}`),
  g: f32(`g${k}`)}));
const origins = ['none', 'simulated', 'interpolated', 'measured'];
const originColour = [[200, 200, 200], [0, 114, 178], [230, 159, 0], [0, 158, 115]];

// Force [N] and slope [N/m] of node i at depth d [m]: the file's own cubic.
function response(tool, i, d) {
  const a = tool.begin[i], b = tool.begin[i + 1], D = tool.depth, F = tool.force, M = tool.slope;
  if (a === b) return null;
  if (d > D[b - 1]) return {force: F[b - 1] + Math.max(0, M[b - 1]) * (d - D[b - 1]), extrapolated: true};
  let k = a;
  while (k < b - 2 && D[k + 1] < d) ++k;
  const h = D[k + 1] - D[k], x = (d - D[k]) / h, s = (F[k + 1] - F[k]) / h, m = M[k], e = M[k + 1];
  return {force: F[k] + h * x * (m + x * (3 * s - 2 * m - e + x * (m + e - 2 * s))), extrapolated: false};
}

// What a node's force loses while held, by term; none where responses are static.
const sharesOf = (tool, i) => tool.tau_s.map((_, k) => tool.g[i * tool.tau_s.length + k]);
const sum = list => list.reduce((a, b) => a + b, 0);
// The share of a held force that stays after t [s].
const stays = (tool, i, t) => 1 - sum(sharesOf(tool, i).map((g, k) => g * (1 - Math.exp(-t / tool.tau_s[k]))));

const state = {tool: 0, colour: 'stiffness', depth: 0, node: -1};
const kinds = {
  stiffness: {name: 'stiffness f/d at the depth', unit: 'N/m',
    at: (t, i) => { const r = response(t, i, state.depth); return r ? r.force / state.depth : NaN; }},
  slope: {name: 'largest slope', unit: 'N/m', at: (t, i) => t.begin[i] < t.begin[i + 1] ? t.slopeMax[i] : NaN},
  depth: {name: 'largest depth', unit: 'mm', at: (t, i) => t.begin[i] < t.begin[i + 1] ? 1e3 * t.depth[t.begin[i + 1] - 1] : NaN},
  error: {name: 'stated error of force', unit: '%', at: (t, i) => t.origin[i] ? 100 * t.error[i] : NaN},
  verified: {name: 'verified error of force', unit: '%', at: (t, i) => t.verified.length ? 100 * t.verified[i] : NaN},
  origin: {name: 'origin', unit: '', at: (t, i) => t.origin[i]},
  relaxes: {name: 'share of a held force that relaxes', unit: '%', relaxing: true, at: (t, i) => t.origin[i] ? 100 * sum(sharesOf(t, i)) : NaN},
  time: {name: 'mean time in which it relaxes', unit: 's', relaxing: true, at: (t, i) => {
    const g = sharesOf(t, i);
    return t.origin[i] ? sum(g.map((part, k) => part * t.tau_s[k])) / (sum(g) || 1) : NaN;
  }},
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
  drawRelaxation();
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

const kPlot = {width: 460, height: 250};

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
  const p = new Plot($('curve'), {...kPlot, x: [0, 1e3 * end], y: [0, 1.05 * top], xName: 'depth d [mm]', yName: 'force f [N]'});
  const at = response(tool, i, state.depth), mark = p.px(1e3 * Math.min(state.depth, end));
  p.add('line', {class: 'mark', x1: mark, x2: mark, y1: p.py(0), y2: p.py(1.05 * top)});
  const points = Array.from({length: 201}, (_, k) => [1e3 * end * k / 200, response(tool, i, end * k / 200).force]);
  p.curve(points, tool.error[i], Array.from(tool.depth.subarray(a, b), (d, k) => [1e3 * d, tool.force[a + k]]));
  text += `, stated error ${tell(100 * tool.error[i], 2)} %. At ${tell(1e3 * state.depth)} mm: ${tell(at.force)} N, ${tell(at.force / state.depth)} N/m${at.extrapolated ? ' (beyond the last sample)' : ''}.`;
  if (tool.tau_s.length) {
    text += ` Held for long, ${tell(100 * (1 - sum(sharesOf(tool, i))))} % of it stay.`;
  }
  $('said').textContent = text;
}

// What stays of the chosen node's force while it is held.
function drawRelaxation() {
  const tool = tools[state.tool], i = state.node, shown = tool.tau_s.length > 0 && i >= 0 && tool.begin[i] < tool.begin[i + 1];
  $('relaxing').hidden = !shown;
  if (!shown) return;
  const x = [0.03 * tool.tau_s[0], 5 * tool.tau_s[tool.tau_s.length - 1]];
  const p = new Plot($('relaxation'), {...kPlot, x, y: [0, 105], xName: 'time since the press [s]', yName: 'force that stays [%]', xLog: true});
  const points = Array.from({length: 121}, (_, k) => x[0] * (x[1] / x[0]) ** (k / 120)).map(t => [t, 100 * stays(tool, i, t)]);
  p.add('path', {class: 'curve', d: p.path(points)});
}

function drawLegend(known) {
  const kind = kinds[state.colour], counts = new Array(30).fill(0);
  if (state.colour === 'origin') {
    $('legend').innerHTML = origins.map((name, k) => `<span><i style="background:${css(originColour[k])}"></i>${name}</span>`).join(' ');
  } else {
    $('legend').innerHTML = `<span>${tell(range[0])}</span><b style="background:linear-gradient(90deg,${info.colours.join()})"></b><span>${tell(range[1])} ${kind.unit}</span> <span><i style="background:${css(originColour[0])}"></i>none</span>`;
  }
  const tool = tools[state.tool], stiff = [];
  for (let i = 0; i < n; ++i) { const v = kinds.stiffness.at(tool, i); if (Number.isFinite(v)) stiff.push(v); }
  stiff.sort((p, q) => p - q);
  if (!stiff.length) { $('histogram').innerHTML = '<p class="hint">No responses.</p>'; return; }
  const low = stiff[0], high = stiff[stiff.length - 1] > low * (1 + 1e-6) ? stiff[stiff.length - 1] : low + Math.max(1e-9, 0.1 * Math.abs(low));
  for (const v of stiff) ++counts[Math.min(29, Math.floor(30 * (v - low) / (high - low)))];
  const most = Math.max(...counts), p = new Plot($('histogram'), {...kPlot, x: [low, high], y: [0, 1.05 * most],
    xName: `stiffness f/d at ${tell(1e3 * state.depth)} mm [N/m]`, yName: 'nodes'});
  counts.forEach((c, k) => {
    const from = low + (high - low) * k / 30, to = low + (high - low) * (k + 1) / 30;
    const bar = p.add('rect', {x: p.px(from) + 0.5, width: p.px(to) - p.px(from) - 1, y: p.py(c), height: p.py(0) - p.py(c),
      fill: state.colour === 'stiffness' ? css(viridis(place((from + to) / 2))) : '#7a8794'});
    bar.append(document.createElementNS(bar.namespaceURI, 'title'));
    bar.firstChild.textContent = `${tell(from)} to ${tell(to)} N/m: ${c} nodes`;
  });
}

function choose(node) {
  state.node = node;
  drawCurve();
  drawRelaxation();
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
  const missing = key => (key === 'verified' && !tools[k].verified.length) || (kinds[key].relaxing && !tools[k].tau_s.length);
  for (const option of $('colour').options) option.disabled = missing(option.value);
  if (missing(state.colour)) $('colour').value = state.colour = 'stiffness';
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
