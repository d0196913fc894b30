// The text of a campaign file, checked while somebody types.
import { setUpSaving } from "./saving.js";

const form = document.querySelector("#campaign");
const QUIET = 400; // ms without a key, after which what was typed is checked
let timer = 0, asked = 0;
const saving = setUpSaving(form, () => { asked += 1; clearTimeout(timer); timer = setTimeout(ask, QUIET); });

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
  saving.differs(found.diff);
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
