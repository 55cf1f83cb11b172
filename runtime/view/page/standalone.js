// The first script of a page that needs no server: unpacks what the page carries, and
// starts the page's own modules.
"use strict";

(async () => {
  const text = (id) => document.getElementById(id).textContent;
  const unpacked = (id) => {
    const packed = Uint8Array.from(atob(text(id)), (digit) => digit.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  };
  try {
    const about = JSON.parse(text("about"));
    const [files, module, database] = await Promise.all(["files", "module", "database"].map(unpacked));
    const texts = JSON.parse(new TextDecoder().decode(files));
    const addresses = {};
    // The address of a module, in which modules that it imports have theirs.
    const file = (path) => {
      addresses[path] ??= URL.createObjectURL(new Blob(
        [texts[path].replace(/^(import [^"]*)"([^"]+)"/gm, (all, what, from) => `${what}"${file(from)}"`)],
        { type: "text/javascript" }));
      return addresses[path];
    };
    window.palpateInside = { file, module, database, ...about };
    const leftOut = document.getElementById("left_out");
    leftOut.hidden = about.left_out === "";
    leftOut.textContent = about.left_out;
    await import(file("/app.js"));
  } catch (error) {
    document.getElementById("state").textContent = "cannot start";
    document.getElementById("message").textContent = error.message;
  }
})();
