// What is folded away is printed too.
addEventListener("beforeprint", () => document.querySelectorAll("details:not(.switches)").forEach((one) => { one.open = true; }));

document.querySelectorAll("figure > script.data").forEach(setUp);
moveModes();
