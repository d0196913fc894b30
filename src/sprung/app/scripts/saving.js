// A campaign file is saved without leaving its page. What was entered stays where saving fails, and so does the reason.
export function setUpSaving(form, check) {
  const saved = document.querySelector("#saved"), failure = document.querySelector("#failure");
  let changed = document.querySelector("#diff").textContent !== "", leaves = false, busy = false;

  form.addEventListener("input", () => { changed = true; saved.hidden = true; check(); });
  form.addEventListener("submit", async (event) => {
    if (leaves) return;
    event.preventDefault();
    if (busy) return;
    busy = true;
    const button = event.submitter, body = new URLSearchParams(new FormData(form));
    if (button?.name) body.set(button.name, button.value);
    form.inert = !button?.value.startsWith("save"); // its answer is another page: what is typed meanwhile would be half of a value there
    const answer = await fetch(form.getAttribute("action"), { method: "POST", body, headers: { Accept: "application/json" } }).catch(() => null);
    const reason = answer === null ? `sprung does not answer. Start it again in the same folder with --port ${location.port}, and open the address that it prints in another tab.` : answer.ok ? "" : (await answer.text()).trim();
    busy = false;
    form.inert = false;
    failure.hidden = !reason;
    failure.textContent = reason && `Nothing was saved: ${reason} What is entered here remains.`;
    if (reason) return;
    const found = await answer.json();
    if (!found.saved) { // its answer is another page
      leaves = true;
      form.requestSubmit(button);
      return;
    }
    form.elements.version.value = found.version;
    form.elements.original.value = JSON.stringify(found.text);
    changed = false;
    saved.hidden = false;
    check();
  });
  addEventListener("beforeunload", (event) => { if (changed && !leaves) event.preventDefault(); });
  addEventListener("keydown", (event) => {
    if (event.key !== "s" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    form.requestSubmit(form.querySelector("button.main[value=save]"));
  });
  return { differs: (lines) => { // from the file
    document.querySelector("#diff").textContent = lines.join("\n");
    document.querySelector("#changes").hidden = !lines.length;
    changed = lines.length > 0;
  } };
}
