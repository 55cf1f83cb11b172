// What lies between the page and the runtime: a server on this machine, a token from the
// address, data, and a socket that comes back by itself. A page that holds its runtime
// has inside.js in this file's place.

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

export async function data(path) {
  const answer = await fetch(path, { headers: { Authorization: `Bearer ${token}` } });
  if (!answer.ok) {
    throw new Error(answer.status === 403
      ? "The address lacks its token: open it as palpate-run view printed it."
      : `${path}: ${answer.status}`);
  }
  return answer;
}

// Calls on.text(text) for every message, and on.gone() when there is no connection.
// @return what sends a text
export function connect(on) {
  let socket = null;
  const open = () => {
    socket = new WebSocket(`ws://${location.host}/live`, ["palpate.1", token]);
    socket.onmessage = (event) => on.text(event.data);
    socket.onclose = () => {
      on.gone();
      setTimeout(open, 1000);
    };
  };
  open();
  return (text) => {
    if (socket.readyState === WebSocket.OPEN) {
      socket.send(text);
    }
  };
}
