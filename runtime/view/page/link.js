// The connection to the runtime, whatever lies between (transport.js).
import { connect, data } from "/transport.js";

// What does not change, and the body: { text, position, normal, stiffness,
// height, triangle }.
export async function fetchBody() {
  const [text, bytes] = await Promise.all([
    data("/body.json").then((answer) => answer.json()),
    data("/body.bin").then((answer) => answer.arrayBuffer()),
  ]);
  const [n, t] = new Uint32Array(bytes, 4, 2);
  let at = 12;
  const take = (Type, count) => {
    const values = new Type(bytes, at, count);
    at += 4 * count;
    return values;
  };
  return {
    text,
    position: take(Float32Array, 3 * n),
    normal: take(Float32Array, 3 * n),
    stiffness: take(Float32Array, n),
    height: take(Float32Array, n),
    triangle: take(Uint32Array, 3 * t),
  };
}

// Calls on[type](message) for every message, and on.gone(why) when there is no connection.
export class Link {
  constructor(on) {
    this.leave = connect({
      text: (text) => {
        const message = JSON.parse(text);
        on[message.type]?.(message);
      },
      gone: (why) => on.gone(why),
    });
  }

  send(message) { this.leave(JSON.stringify(message)); }
  set(settings) { this.send({ type: "set", ...settings }); }
  run(what) { this.send({ type: "run", do: what }); }
  device(what, more = {}) { this.send({ type: "device", do: what, ...more }); }
  node(node) { this.send({ type: "node", node }); }
  field(node) { this.send({ type: "field", node }); }
  // @param more of several contacts or hands: { hand, turn }.
  hold(target, more = {}) { this.send({ type: "point", hold: true, target_m: target, ...more }); }
  letGo(more = {}) { this.send({ type: "point", hold: false, ...more }); }
}
