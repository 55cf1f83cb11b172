// A body whose responses come while the page shows it: their colours, and how the
// service that computes them is.
import { drawColourBar } from "/bars.js";

const get = (id) => document.getElementById(id);
const kTroubles = ["lost", "nonsense", "another scene", "failed"];

export class Served {
  constructor(app) {
    this.app = app;
    app.body.quality = new Uint8Array(app.body.stiffness.length);  // 0 none, 1 preliminary, 2 final
    get("service").hidden = false;
    get("anew").addEventListener("click", () => app.link.run("anew"));
    get("colour_bar").hidden = true;  // until there is a range
  }

  // Of some nodes, as they come.
  answers(message) {
    const { body, view } = this.app;
    message.node.forEach((node, k) => {
      body.stiffness[node] = message.stiffness[k] ?? NaN;
      body.quality[node] = 1 + message.final[k];
    });
    Object.assign(body.text.map, { low_n_per_m: message.low_n_per_m, high_n_per_m: message.high_n_per_m });
    if (message.force_max_n > 0) {
      drawColourBar(body.text.map);
      get("colour_bar").hidden = view === null;
      body.text.force_max_n = message.force_max_n;
    }
    view?.recolourBody();
  }

  show(state) {
    const { service } = state;
    const put = (id, text) => { if (get(id).textContent !== text) { get(id).textContent = text; } };
    const trouble = kTroubles.includes(service.state);
    const whole = service.state === "done";
    const counts = service.nodes > 0
      ? `${service.answered} of ${service.nodes} places answer, ${service.finished} of them finally`
      : "no place answers yet";
    const stage = service.state === "serving" ? service.stage || "begins" : service.state;
    const why = service.detail ? ` (${service.detail})` : "";
    put("service_text", whole ? `the body is whole: ${service.detail}` : `filling in, ${stage}${why}: ${counts}`);
    get("service").classList.toggle("warn", trouble || service.state === "silent");
    const ticks = service.ticks.reduce((sum, value) => sum + value, 0);
    put("service_shares", ticks > 0
      ? `pressed so far: ${(100 * service.ticks[0] / ticks).toFixed(1)} % without an answer, ` +
        (service.ticks[1] > 0 ? `${(100 * service.ticks[1] / ticks).toFixed(1)} % estimated from the material, ` : "") +
        `${(100 * service.ticks[2] / ticks).toFixed(1)} % with a preliminary one`
      : "");
    const pressed = state.holding && state.penetration_m > 0;
    put("service_here", pressed && service.here === "none" ? "no answer here yet: no force"
      : pressed && service.here === "estimated" ? "no answer here yet: a force as of a half space of its material"
      : pressed && state.shift_m > 2e-4 ? "answered while it was pressed: lift the tool to feel all of it" : "");
    put("service_changed", service.changed ? "The scene's file has changed." : "");
    get("anew").hidden = !service.changed && !trouble;
  }
}
