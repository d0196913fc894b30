// Jobs on the page: state, step and output as the server reports them. Without this script a reload shows the same.
const panels = [...document.querySelectorAll("[data-job]")];
const over = (state) => !["waiting", "running"].includes(state);
const part = (panel, name) => panel.querySelector(`[data-part="${name}"]`);
let source = null;

function show(panel, job) {
  const before = panel.dataset.state;
  panel.dataset.state = job.state;
  panel.classList.remove(before);
  panel.classList.add(job.state);
  const since = job.elapsed === null || job.elapsed === undefined ? "" : `, ${clock(job.elapsed)}`;
  part(panel, "state").textContent = job.state + since;
  if (job.step) part(panel, "now").textContent = job.step;
  const bar = part(panel, "progress");
  if (job.done === null || job.done === undefined) bar.removeAttribute("value");
  else bar.value = job.done;
  part(panel, "left").textContent = over(job.state) ? "" : remaining(panel, job);
  part(panel, "cancel").hidden = over(job.state);
  if (over(job.state) && !over(before)) end(panel, job);
}

// As in a terminal: from the part of the stage that is done, once it has taken two seconds.
function remaining(panel, job) {
  if (panel.dataset.stage !== job.stage) { panel.dataset.stage = job.stage ?? ""; panel.dataset.since = job.elapsed ?? 0; }
  const inStage = (job.elapsed ?? 0) - Number(panel.dataset.since);
  if (!job.done || job.done >= 1 || inStage < 2) return "";
  return `about ${clock(inStage * (1 - job.done) / job.done)} more`;
}

const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")} min`;

// The whole list of steps and the output are fetched when somebody looks at them.
async function fetchAll(panel) {
  const answer = await fetch(`/jobs/${panel.dataset.job}`, { headers: { Accept: "application/json" } });
  if (!answer.ok) return;
  const job = await answer.json();
  part(panel, "steps").replaceChildren(...job.steps.map((step) => {
    const line = document.createElement("li");
    line.textContent = step.text;
    return line;
  }));
  part(panel, "count").textContent = job.steps.length;
  const text = [job.messages, job.output].filter(Boolean).join("\n");
  part(panel, "output").textContent = text;
  part(panel, "message").hidden = !text;
  show(panel, job);
}

// An event tells the last step only: the list is fetched once a second at most, while it is open.
function later(panel) {
  if (panel.dataset.fetching || !part(panel, "steps").closest("details").open) return;
  panel.dataset.fetching = "yes";
  setTimeout(async () => {
    await fetchAll(panel);
    delete panel.dataset.fetching;
    part(panel, "steps").scrollTop = part(panel, "steps").scrollHeight;
  }, 1000);
}

async function end(panel, job) {
  document.querySelector("#announcements").textContent = `${job.title}: ${job.state}`;
  if (panel.dataset.next) location.assign(panel.dataset.next);
  else await fetchAll(panel);
}

// A browser has six connections to a server for all tabs: only a tab that is seen keeps one, and only while something runs.
function follow() {
  const wanted = !document.hidden && panels.some((panel) => !over(panel.dataset.state));
  if (!wanted) { source?.close(); source = null; }
  if (!wanted || source) return;
  panels.forEach(fetchAll);
  source = new EventSource("/events");
  source.addEventListener("job", (event) => {
    const job = JSON.parse(event.data);
    const own = panels.filter((panel) => panel.dataset.job === job.id);
    for (const panel of own) {
      show(panel, job);
      later(panel);
    }
    if (own.length) follow();
  });
}
document.addEventListener("visibilitychange", follow);
follow();

// The time that has passed goes on between the steps.
setInterval(() => {
  for (const panel of panels) {
    if (panel.dataset.state !== "running") continue;
    const state = part(panel, "state");
    const match = /(\d+):(\d\d) min/.exec(state.textContent);
    if (match) state.textContent = `running, ${clock(60 * Number(match[1]) + Number(match[2]) + 1)}`;
  }
}, 1000);
