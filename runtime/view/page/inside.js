// In transport.js's place: the runtime is in the page, as WebAssembly in a worker, and
// steps by itself however long a picture takes.

// By the page's first script (formats/report/page/standalone.js): files by name, module
// and database as bytes, name, tools, ports of a device's service.
const { file, module, database, name, tools, device_ports } = window.palpateInside;

const worker = new Worker(file("/runtime_worker.js"));
const started = new Promise((resolve, reject) => {
  worker.addEventListener("message", ({ data: [type, value] }) => {
    if (type === "started") {
      resolve(value);
    } else if (type === "device") {  // the other end of a line to it
      new Worker(file("/device_worker.js")).postMessage({ line: value, ports: device_ports }, [value]);
    } else if (type === "failed") {
      reject(new Error(value));
    }
  });
});
worker.postMessage({ module, database, name, tools, device_ports }, [module, database]);

// @return as fetch() does
export async function data(path) {
  const { text, bytes } = await started;
  return new Response(path === "/body.json" ? text : bytes);
}

// Calls on.text(text) for every message, and on.gone(why) when the runtime has ended.
// @return what sends a text
export function connect(on) {
  worker.addEventListener("message", ({ data: [type, value] }) => {
    if (type === "text") {
      on.text(value);
    } else if (type === "failed") {
      on.gone(value);
    }
  });
  worker.postMessage("go");
  return (text) => worker.postMessage(text);
}
