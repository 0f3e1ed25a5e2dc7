// Uploads dropped or chosen files one after another, with progress, and shows each answer where it arrives.
// Without this script the form posts as it stands and the server answers with the same cards.
const form = document.getElementById("upload");
const input = document.getElementById("files");
const outcomes = document.getElementById("outcomes");
const tally = document.getElementById("tally");
const queue = [];
let busy = false;

form.classList.add("scripted");
form.querySelectorAll("[hidden]").forEach((part) => part.removeAttribute("hidden"));

function waiting(file) {
  const card = document.createElement("article");
  card.className = "outcome waiting";
  const name = document.createElement("p");
  name.textContent = file.name;
  const bar = document.createElement("progress");
  bar.max = 1;
  bar.value = 0;
  bar.setAttribute("aria-label", form.dataset.saidUpload.replace("…", () => file.name));
  card.append(name, bar);
  outcomes.prepend(card);
  return card;
}

function failed(card, message) {
  card.className = "outcome refused";
  card.dataset.became = "failed";
  card.querySelector("progress")?.remove();
  const words = document.createElement("p");
  words.textContent = message;
  card.append(words);
}

// How many files became what; what needs a person comes first.
function count() {
  const cards = (became) => outcomes.querySelectorAll(`[data-became=${became}]`);
  for (const part of tally.children) {
    part.querySelector("b").textContent = cards(part.dataset.became).length;
    part.hidden = !cards(part.dataset.became).length;
  }
  tally.hidden = outcomes.children.length < 2;
  outcomes.prepend(...cards("failed"), ...cards("open"));
}

function show(card, request) {
  const answer = new DOMParser().parseFromString(request.responseText, "text/html");
  const cards = answer.querySelectorAll("#outcomes > .outcome");
  if (cards.length) {
    card.replaceWith(...cards);
    cards.forEach((one) => follow(one));
    if (outcomes.children.length === 1 && !queue.length) outcomes.querySelector("form.table")?.submit();
  }
  else failed(card, answer.querySelector("#problem")?.textContent.trim() ?? form.dataset.saidStatus.replace("…", request.status));
}

// A card whose diagnosis is still being made looks again, ever more slowly, until it is.
function follow(card, pause = 1000) {
  if (!card.dataset.follow) return;
  setTimeout(async () => {
    let next = card;
    try {
      const answer = await fetch(card.dataset.follow, { headers: { Accept: "text/html" } });
      const found = new DOMParser().parseFromString(await answer.text(), "text/html").querySelector(".outcome");
      if (answer.ok && found) {
        if (found.textContent !== card.textContent) card.replaceWith(found);
        if (found.dataset.became !== card.dataset.became) count();
        next = found.ownerDocument === document ? found : card;
        if (!found.dataset.follow) return;
      }
    } catch {
      // the server does not answer just now
    }
    follow(next, next.dataset.every ? 1000 * next.dataset.every : Math.min(1.5 * pause, 60000));
  }, pause);
}

function send(file, card) {
  return new Promise((done) => {
    const body = new FormData();
    body.append("files", file);
    for (const name of ["check", "look"]) if (form.elements[name]?.checked) body.append(name, "yes");
    const request = new XMLHttpRequest();
    const bar = card.querySelector("progress");
    request.upload.onprogress = (event) => {
      if (event.loaded < event.total) bar.value = event.loaded / event.total;
      else bar.removeAttribute("value"); // received; being calibrated
    };
    request.onload = () => done(show(card, request));
    request.onerror = () => done(failed(card, form.dataset.saidUnanswered));
    request.open("POST", form.action);
    request.setRequestHeader("Accept", "text/html");
    request.send(body);
  });
}

async function work() {
  if (busy) return;
  busy = true;
  while (queue.length) {
    await send(...queue.shift());
    count();
  }
  busy = false;
}

function take(files) {
  for (const file of files) queue.push([file, waiting(file)]);
  input.value = "";
  work();
}

document.querySelectorAll(".outcome[data-follow]").forEach((card) => follow(card));
form.addEventListener("submit", (event) => {
  event.preventDefault();
  take([...input.files]);
});
input.addEventListener("change", () => take([...input.files]));
for (const name of ["dragenter", "dragover"]) {
  document.addEventListener(name, (event) => {
    event.preventDefault();
    form.classList.add("over");
  });
}
document.addEventListener("dragleave", (event) => {
  if (!event.relatedTarget) form.classList.remove("over");
});
document.addEventListener("drop", (event) => {
  event.preventDefault();
  form.classList.remove("over");
  if (event.dataTransfer.files.length) take([...event.dataTransfer.files]);
});
