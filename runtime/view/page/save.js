// Pictures, videos and tables of what the page shows.

function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function saveTable(history) {
  download(new Blob([history.csv()], { type: "text/csv" }), "palpate.csv");
}

// To be called right after drawing: the picture is gone with the next frame.
export function savePicture(canvas) {
  canvas.toBlob((blob) => blob && download(blob, "palpate.png"), "image/png");
}

let recorder = null;

// Starts or ends a video; true while one is made.
export function toggleVideo(canvas) {
  if (recorder) {
    recorder.stop();
    recorder = null;
    return false;
  }
  const parts = [];
  recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: "video/webm" });
  recorder.ondataavailable = (event) => parts.push(event.data);
  recorder.onstop = () => download(new Blob(parts, { type: "video/webm" }), "palpate.webm");
  recorder.start();
  return true;
}
