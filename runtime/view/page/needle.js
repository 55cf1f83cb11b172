// A needle: where the hand aims it, and what is said of it beside the picture.
import { NeedlePlot } from "/needle_plot.js";

const kAlignedM = 3e-4;  // [m] off the aim's axis, at least, where the needle may go in

const get = (id) => document.getElementById(id);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (point, axis, s) => point.map((v, k) => v + s * axis[k]);

function off(point, axis, at) {
  const away = at.map((v, k) => v - point[k]);
  return Math.hypot(...along(away, axis, -dot(away, axis)));
}

// As deep as a page may push a needle: past the deepest layer by what the surface yields.
export function deepestPress({ puncture, depth_max_m: most }) {
  return (puncture ? puncture.deepest_m : 0) + 2 * most;
}

// Of a needle, its own colour for each material.
export const layerColour = (material) => `layer${material % 8}`;

export class Needle {
  // @param body as fetchBody() has it.
  constructor(body) {
    this.body = body;
    this.puncture = body.text.puncture;
    this.aimed = null;  // the aim that the needle stands over, or is in
    for (const part of document.querySelectorAll(".of_needle")) {
      part.hidden = false;
    }
    this.plot = new NeedlePlot(get("needle_plot"), this.puncture);
    get("depth_name").textContent = "Depth of the tip";
    get("hint").textContent = "Shift + drag pushes in, wheel: deeper · P [ ] by keys · ? all keys";
    this.puncture.materials.forEach((name, i) => {
      const row = document.createElement("p");
      const key = document.createElement("i");
      key.className = "key layer";
      key.style.background = `var(--${layerColour(i)})`;
      row.append(key, name);
      get("layers_legend").append(row);
    });
  }

  // The channel that the needle is in, or that begins at a place.
  channelAt(place) {
    const { needle } = this.state ?? {};
    if (!needle || needle.in >= 0) {
      return needle?.channels[needle.in];
    }
    const near = Math.max(this.body.text.tool.radius_m, 2 * this.puncture.mouth_m);
    const far = ({ entry_m: entry }) => Math.hypot(...entry.map((v, k) => v - place.point[k]));
    const [best] = [...needle.channels].sort((a, b) => far(a) - far(b));
    return best && far(best) <= near ? best : undefined;
  }

  // Where the tool's reference point is to go. A needle that is not over its aim goes
  // there first: it would enter on the way.
  target(place, depth_m) {
    const channel = this.channelAt(place);
    const [point, axis] = channel ? [channel.entry_m, channel.axis] : [place.point, place.normal];
    const height = this.body.height[place.node];
    const aim = channel ? `${point}` : `${place.point}`;
    const aligned = Math.max(kAlignedM, 0.8 * this.puncture.mouth_m);
    if (this.aimed !== aim && (this.state?.needle.in >= 0 || off(point, axis, this.state?.tool_m ?? point) < aligned)) {
      this.aimed = aim;
    }
    const clear = 0.5 * this.body.text.depth_max_m;
    return along(point, axis, height - (this.aimed === aim ? depth_m : Math.min(depth_m, -clear)));
  }

  forget() { this.aimed = null; }

  // From the runtime.
  take(state) {
    this.state = state;
    this.plot.take(state);
  }

  // @param put (id, text) writes where it differs.
  show({ needle }, put) {
    const { channel } = this.plot;
    const { materials } = this.puncture;
    const last = channel ? channel.broke_n.length - 1 : -1;
    put("membranes", String(needle.membranes));
    put("layer_now", needle.in >= 0 ? `· tip in ${materials[channel.materials[last]]}` : needle.channels.length > 0
      ? `· ${needle.channels.length} ${needle.channels.length > 1 ? "channels" : "channel"}` : "");
    put("rupture", channel?.broke_n[last]?.toFixed(3) ?? "–");
    put("rupture_at", last >= 0 ? `N, ${materials[channel.materials[last]]}` : "");
    for (const [id, joule] of [["crack", needle.crack_j], ["released", needle.released_j], ["shaft", needle.shaft_j]]) {
      put(id, (1e3 * joule).toFixed(3));
    }
    put("refused", needle.refused > 0 ? "No room for another channel: Reset begins anew." : "");
  }
}
