// The connection to the runtime: a token from the address, data, and a socket that comes
// back by itself.

const kTokenKey = "palpate-token";

// Taken out of the address, so that it stands in no history and no screenshot.
function takeToken() {
  const inAddress = location.hash.slice(1);
  if (/^[0-9a-f]{32}$/.test(inAddress)) {
    sessionStorage.setItem(kTokenKey, inAddress);
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem(kTokenKey) ?? "";
}

const token = takeToken();

async function data(path) {
  const answer = await fetch(path, { headers: { Authorization: `Bearer ${token}` } });
  if (!answer.ok) {
    throw new Error(answer.status === 403
      ? "The address lacks its token: open it as palpate-run view printed it."
      : `${path}: ${answer.status}`);
  }
  return answer;
}

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

// Calls on[type](message) for every message, and on.gone() when there is no connection.
export class Link {
  constructor(on) {
    this.on = on;
    this.open();
  }

  open() {
    this.socket = new WebSocket(`ws://${location.host}/live`, ["palpate.1", token]);
    this.socket.onmessage = (event) => {
      const message = JSON.parse(event.data);
      this.on[message.type]?.(message);
    };
    this.socket.onclose = () => {
      this.on.gone();
      setTimeout(() => this.open(), 1000);
    };
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify(message));
    }
  }

  set(settings) { this.send({ type: "set", ...settings }); }
  run(what) { this.send({ type: "run", do: what }); }
  node(node) { this.send({ type: "node", node }); }
  field(node) { this.send({ type: "field", node }); }
  // @param more of several contacts or hands: { hand, turn }.
  hold(target, more = {}) { this.send({ type: "point", hold: true, target_m: target, ...more }); }
  letGo(more = {}) { this.send({ type: "point", hold: false, ...more }); }
}
