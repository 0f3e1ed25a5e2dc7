// A few keys for whoever works through lists: / ? j k Enter x. Pages are whole without them. They do nothing while
// somebody writes, chooses or holds a modifier, and can be switched off on the page of help (WCAG 2.1.4).
const OFF = "imu-health-keys-off";
const ROWS = "table.units tbody tr, table.sessions tbody tr, table.uploads tbody tr, section.flag";
const WRITES = "input, select, textarea, [contenteditable]";
let at = -1;

function isOff() {
  try {
    return localStorage.getItem(OFF) === "yes";
  } catch {
    return false; // a browser that stores nothing keeps the keys on
  }
}

function rows() {
  return [...document.querySelectorAll(ROWS)].filter((row) => row.getClientRects().length);
}

function go(step) {
  const all = rows();
  if (!all.length) return;
  all[at]?.classList.remove("at");
  at = Math.min(Math.max(at + step, 0), all.length - 1);
  all[at].classList.add("at");
  all[at].scrollIntoView({ block: "nearest" });
  (link(all[at]) ?? all[at]).focus({ preventScroll: true });
}

function link(row) {
  return row.querySelector("th a[href], h2 a[href], h3 a[href], a[href]");
}

function tick() {
  const box = rows()[at]?.querySelector("input[type=checkbox]");
  if (box) box.click();
  return Boolean(box);
}

const ACTIONS = {
  "/": () => {
    const field = document.querySelector("input[type=search]");
    field?.focus();
    field?.select();
    return Boolean(field);
  },
  "?": () => location.assign("/help#keys"),
  j: () => go(1),
  k: () => go(-1),
  x: tick,
};

document.addEventListener("keydown", (event) => {
  const writes = event.target instanceof Element && event.target.closest(WRITES) && !event.target.matches("[type=checkbox]");
  if (event.ctrlKey || event.metaKey || event.altKey || event.isComposing || writes || isOff()) return;
  const action = Object.hasOwn(ACTIONS, event.key) ? ACTIONS[event.key] : undefined;
  if (action && action() !== false) event.preventDefault();
});

const choice = document.getElementById("keys-choice");
if (choice) {
  const box = choice.querySelector("input");
  box.checked = !isOff();
  box.addEventListener("change", () => {
    try {
      localStorage.setItem(OFF, box.checked ? "no" : "yes");
    } catch {
      box.checked = true;
    }
  });
  choice.hidden = false;
}
