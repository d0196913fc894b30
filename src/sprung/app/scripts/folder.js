// Recordings that are dropped on the page or chosen, sent one after the other; and the search in their names.
const form = document.querySelector(".upload");
const list = form.querySelector(".uploads");
const into = form.querySelector("#into");
const waiting = [];
let sending = false, failed = false;

function add(files) {
  for (const file of files) {
    const line = document.createElement("li");
    const bar = document.createElement("progress");
    const state = document.createElement("span");
    bar.max = Math.max(file.size, 1);
    bar.value = 0;
    bar.setAttribute("aria-label", `Sent of ${file.name}`);
    state.textContent = " waits";
    line.append(file.name, state, bar);
    list.append(line);
    waiting.push({ file, bar, state, folder: into.value });
  }
  send();
}

async function send() {
  if (sending) return;
  sending = true;
  addEventListener("beforeunload", warn);
  while (waiting.length) await sendOne(waiting.shift());
  removeEventListener("beforeunload", warn);
  sending = false;
  if (!failed) location.reload();
  else if (!list.querySelector("a")) {
    const link = document.createElement("a");
    link.href = "/";
    link.textContent = "Show the folder as it is now";
    list.append(document.createElement("li"));
    list.lastElementChild.append(link);
  }
}

function sendOne({ file, bar, state, folder }) {
  return new Promise((finished) => {
    const name = folder ? `${folder}/${file.name}` : file.name;
    const request = new XMLHttpRequest(); // fetch does not tell how much was sent
    request.open("PUT", `/upload/${name.split("/").map(encodeURIComponent).join("/")}`);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.addEventListener("progress", (event) => { bar.value = event.loaded; state.textContent = ` ${Math.round(100 * event.loaded / Math.max(event.total, 1))} %`; });
    const end = (text, ok) => {
      state.textContent = text;
      if (!ok) { state.className = "wrong"; failed = true; }
      bar.remove();
      finished();
    };
    request.addEventListener("load", () => (request.status < 300 ? end(" added", true) : end(`: ${request.responseText.trim()}`, false)));
    request.addEventListener("error", () => end(": the connection was lost; nothing was written. Add it again.", false));
    request.send(file);
  });
}

const warn = (event) => event.preventDefault();

form.addEventListener("submit", (event) => event.preventDefault());
form.querySelector("#files").addEventListener("change", (event) => { add(event.target.files); event.target.value = ""; });
addEventListener("dragover", (event) => {
  if (![...event.dataTransfer.types].includes("Files")) return;
  event.preventDefault();
  form.classList.add("over");
});
addEventListener("dragleave", (event) => { if (!event.relatedTarget) form.classList.remove("over"); });
addEventListener("drop", (event) => {
  if (![...event.dataTransfer.types].includes("Files")) return;
  event.preventDefault();
  form.classList.remove("over");
  add(event.dataTransfer.files);
});

// The search: all words must stand in the name.
const filter = document.querySelector("#filter");
filter?.addEventListener("input", () => {
  const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
  let found = 0;
  for (const line of document.querySelectorAll(".files li")) {
    line.hidden = !words.every((word) => line.dataset.name.includes(word));
    if (!line.hidden) found++;
  }
  document.querySelector("#found").textContent = words.length ? `${found} found` : "";
  if (words.length) document.querySelectorAll(".recordings details").forEach((details) => { details.open = true; });
});
