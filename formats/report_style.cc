#include "formats/report_text.h"

namespace palpate {

const char* const report_style = R"css(
:root { --ink: #1c2733; --soft: #5b6b7a; --line: #d7dde3; --page: #f4f6f8; --card: #fff; --curve: #0072b2; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6ebf0; --soft: #9fb0c0; --line: #3a4654; --page: #161c23; --card: #1f2731; --curve: #56b4e9; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1180px; padding: 20px; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 22px; margin: 0; }
h2 { font-size: 15px; margin: 0 0 8px; }
.sub, .hint, .note { color: var(--soft); margin: 2px 0 14px; overflow-wrap: anywhere; }
.note { border-left: 3px solid #e69f00; padding-left: 10px; }
main { display: grid; grid-template-columns: minmax(0, 1.25fr) minmax(0, 1fr); gap: 14px; }
section { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 14px; min-width: 0; }
.tall { grid-row: span 2; }
.wide { grid-column: 1 / -1; }
@media (max-width: 800px) { main { grid-template-columns: minmax(0, 1fr); } }
#body { display: block; width: 100%; height: 480px; cursor: grab; touch-action: none; border-radius: 6px; }
#body:focus-visible { outline: 2px solid var(--curve); }
.hint { margin-top: 10px; }
.controls { display: grid; grid-template-columns: auto 1fr; gap: 6px 12px; align-items: center; margin-top: 10px; }
select, input { font: inherit; width: 100%; min-width: 0; color: var(--ink); background: var(--card); }
.row { display: flex; gap: 10px; align-items: center; }
.row span { white-space: nowrap; min-width: 5em; text-align: right; }
#legend { display: flex; flex-wrap: wrap; gap: 4px 12px; align-items: center; margin-top: 8px; min-height: 26px; }
#legend b { flex: 1 1 120px; max-width: 260px; height: 12px; border-radius: 3px; }
#legend i { display: inline-block; width: 12px; height: 12px; border-radius: 3px; margin-right: 5px; }
svg { display: block; width: 100%; height: auto; }
svg text { font: 12px system-ui, sans-serif; fill: var(--soft); }
svg .grid { stroke: var(--line); }
svg .mark { stroke: #d55e00; stroke-dasharray: 4 3; }
svg .curve { fill: none; stroke: var(--curve); stroke-width: 2; }
svg circle { fill: var(--curve); }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: 4px 12px 4px 0; border-top: 1px solid var(--line);
  font-weight: normal; overflow-wrap: anywhere; }
th { color: var(--soft); white-space: nowrap; width: 8em; }
pre { overflow: auto; max-height: 420px; background: var(--page); padding: 10px; border-radius: 6px; font-size: 13px; }
kbd { border: 1px solid var(--line); border-radius: 4px; padding: 0 4px; font-size: 12px; }
)css";

const char* const report_body = R"html(
<section class="tall" aria-label="Body">
<canvas id="body" tabindex="0" role="img" aria-label="The body, coloured. Arrow keys turn it, plus and minus zoom, n and p choose nodes, Enter the node in the middle."></canvas>
<div id="legend"></div>
<div class="controls">
<label for="colour">Colour</label><select id="colour"></select>
<label for="depth">Depth</label><div class="row"><input id="depth" type="range" min="1" max="100" value="50"><span id="depthsaid"></span></div>
<label for="tool">Tool</label><select id="tool"></select>
</div>
<p class="hint">Drag turns, the wheel zooms, a click chooses a node. Keys: <kbd>&larr;</kbd> <kbd>&uarr;</kbd> <kbd>&darr;</kbd> <kbd>&rarr;</kbd> turn, <kbd>+</kbd> <kbd>-</kbd> zoom, <kbd>n</kbd> <kbd>p</kbd> next and previous node, <kbd>Enter</kbd> the node in the middle, <kbd>Home</kbd> resets.</p>
</section>
<section aria-label="Curve"><h2>Response of the chosen node</h2><div id="curve"><p class="hint">No node is chosen: click on the body.</p></div><p id="said" class="hint" aria-live="polite"></p></section>
<section aria-label="Histogram"><h2>Stiffness over the nodes</h2><div id="histogram"></div></section>
)html";

}  // namespace palpate
