// The text of a campaign file, checked while somebody types.
const form = document.querySelector("#campaign");
const QUIET = 400; // ms without a key, after which what was typed is checked
let timer = 0, asked = 0, changed = document.querySelector("#diff").textContent !== "", sent = false;

form.addEventListener("input", () => { changed = true; clearTimeout(timer); timer = setTimeout(ask, QUIET); });
form.addEventListener("submit", () => { sent = true; });
addEventListener("beforeunload", (event) => { if (changed && !sent) event.preventDefault(); });
addEventListener("keydown", (event) => {
  if (event.key !== "s" || !(event.ctrlKey || event.metaKey)) return;
  event.preventDefault();
  form.requestSubmit(form.querySelector("button.main"));
});

// What was typed before this script was loaded.
const text = form.querySelector("#text");
if (text.value !== text.defaultValue) ask();

async function ask() {
  const own = ++asked;
  const answer = await fetch(form.getAttribute("action").replace("/campaign?", "/campaign/live?"), { method: "POST", body: new URLSearchParams(new FormData(form)) }).catch(() => null);
  if (own !== asked || !answer?.ok) return;
  const found = await answer.json();
  document.querySelector("#state").textContent = found.state;
  fill("#general", found.problems, (one) => `found ${one.found}; expected ${one.expected}. ${one.do}`);
  fill("#gaps", found.missing, (one) => one.expected);
  document.querySelector("#diff").textContent = found.diff.join("\n");
  document.querySelector("#changes").hidden = !found.diff.length;
  changed = found.diff.length > 0;
}

function fill(list, entries, text) {
  document.querySelector(list).replaceChildren(...entries.map((entry) => {
    const line = document.createElement("li");
    const where = document.createElement("strong");
    where.textContent = entry.where;
    line.append(where, `: ${text(entry)}`);
    return line;
  }));
}
