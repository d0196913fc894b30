// The modes of the vehicle, moving.

function moveModes() {
  const held = document.getElementById("wire-car");
  if (!held) return;
  const { places, edges, struts, circles } = JSON.parse(held.textContent);
  const cars = [...document.querySelectorAll("svg.car")].map((svg) => ({
    edges: svg.querySelector(".edges"),
    struts: svg.querySelector(".struts"),
    circles: [...svg.querySelectorAll(".wheel")],
    swing: svg.dataset.swing.split(" ").map((part) => part.split(",").map(Number)),
    creeps: "creeps" in svg.dataset,
  }));
  const lines = (pairs, y) => pairs.map(([i, j]) => `M${places[i][0]} ${y[i]}L${places[j][0]} ${y[j]}`).join("");

  // Each node rises by the real part of its complex displacement turned by the phase; an overdamped mode decays without swinging.
  function draw(phase) {
    for (const car of cars) {
      const decay = Math.exp(-phase / 2);
      const turn = car.creeps ? [decay, 0] : [Math.cos(phase), Math.sin(phase)];
      const y = places.map((place, i) => (place[1] - car.swing[i][0] * turn[0] + car.swing[i][1] * turn[1]).toFixed(1));
      car.edges.setAttribute("d", lines(edges, y));
      car.struts.setAttribute("d", lines(struts, y));
      car.circles.forEach((circle, k) => circle.setAttribute("cy", y[circles[k]]));
    }
  }

  const button = document.getElementById("play");
  const cycle = 1700; // ms
  let playing = false, start = 0, phase = 0;
  function step(now) {
    if (!playing) return;
    phase = ((now - start) / cycle * 2 * Math.PI) % (2 * Math.PI);
    draw(phase);
    requestAnimationFrame(step);
  }
  function set(on) {
    playing = on;
    button.textContent = on ? "Pause" : "Play";
    if (on) {
      start = performance.now() - phase / (2 * Math.PI) * cycle;
      requestAnimationFrame(step);
    }
  }
  button.hidden = false;
  button.addEventListener("click", () => set(!playing));
  addEventListener("beforeprint", () => { set(false); phase = 0; draw(0); });
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) set(true);
}
