// The form of a campaign: checked while somebody types, sensors moved in the sketch, recordings with their limits.
import { setUpSaving } from "./saving.js";
import { setUpSketch } from "./sketch.js";
import { setUpRecordings } from "./drops.js";

const form = document.querySelector("#campaign");
const QUIET = 350; // ms without a key, after which what was typed is checked
let timer = 0, asked = 0;

const byData = (name, value) => form.querySelector(`[data-${name}="${CSS.escape(value)}"]`);
const body = () => new URLSearchParams(new FormData(form));

function listOf(texts) {
  return texts.map((text) => {
    const line = document.createElement("li");
    line.textContent = text;
    return line;
  });
}

function check() {
  asked += 1; // an answer that is under way is about something else
  clearTimeout(timer);
  timer = setTimeout(ask, QUIET);
}

async function ask() {
  const own = ++asked;
  const answer = await fetch(form.getAttribute("action").replace("/campaign?", "/campaign/live?"), { method: "POST", body: body() }).catch(() => null);
  if (own !== asked) return; // a later question was asked meanwhile
  if (!answer?.ok) {
    document.querySelector("#state").textContent = answer ? (await answer.text()).trim() : "sprung does not answer. Start it again; what is entered here remains.";
    return;
  }
  show(await answer.json());
}

function show(found) {
  document.querySelector("#state").textContent = found.state;
  document.querySelector("#general").replaceChildren(...listOf(found.general));
  for (const list of form.querySelectorAll("[data-group]")) list.replaceChildren(...listOf(found.groups[list.dataset.group]?.problems ?? []));
  for (const gap of form.querySelectorAll("[data-group-gap]")) {
    const gaps = found.groups[gap.dataset.groupGap]?.gaps ?? [];
    gap.hidden = !gaps.length;
    gap.textContent = `To be filled in: ${gaps.join("; ")}`;
  }
  for (const field of form.querySelectorAll("[data-field]")) {
    const own = found.fields[field.dataset.field];
    const problems = own?.problems ?? [];
    byData("problem", field.dataset.field).textContent = problems.join(" ");
    const gap = byData("gap", field.dataset.field);
    gap.hidden = !own?.missing || problems.length > 0;
    if (own?.missing) gap.textContent = `To be filled in: ${own.missing}`;
    field.classList.toggle("missing", Boolean(own?.missing));
    const leaveOut = field.querySelector("[data-leave-out]");
    if (leaveOut) leaveOut.hidden = !own?.missing;
    field.querySelectorAll("[aria-invalid]").forEach((input) => input.setAttribute("aria-invalid", String(problems.length > 0)));
    if (problems.length || own?.missing) field.closest("details.more")?.setAttribute("open", "");
  }
  const where = found.where.map((each) => {
    const line = document.createElement("li");
    const link = document.createElement("a");
    link.href = `#${each.id}`;
    link.textContent = each.text;
    line.append(link);
    return line;
  });
  document.querySelector("#where").replaceChildren(...where);
  saving.differs(found.diff);
  sketch.replace(found.sketch);
}

// Return in a field saves nothing by accident: it goes on to the check.
form.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && event.target.matches("input:not([type=checkbox])")) event.preventDefault();
});

const saving = setUpSaving(form, check);
const sketch = setUpSketch(form, check);
setUpRecordings(form, body);
// What was typed before this script was loaded.
if ([...form.querySelectorAll("input:not([type=hidden])")].some((input) => input.value !== input.defaultValue || input.checked !== input.defaultChecked)) check();
