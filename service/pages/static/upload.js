// Uploads dropped or chosen files one after another, with progress, and shows each answer where it arrives.
// Without this script the form posts as it stands and the server answers with the same cards.
const form = document.getElementById("upload");
const input = document.getElementById("files");
const outcomes = document.getElementById("outcomes");
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
  bar.setAttribute("aria-label", `Upload of ${file.name}`);
  card.append(name, bar);
  outcomes.prepend(card);
  return card;
}

function failed(card, message) {
  card.className = "outcome refused";
  card.querySelector("progress")?.remove();
  const words = document.createElement("p");
  words.textContent = message;
  card.append(words);
}

function show(card, request) {
  const answer = new DOMParser().parseFromString(request.responseText, "text/html");
  const cards = answer.querySelectorAll("#outcomes > .outcome");
  if (cards.length) card.replaceWith(...cards);
  else failed(card, answer.querySelector("#problem")?.textContent.trim() ?? `The server answered ${request.status}.`);
}

function send(file, card) {
  return new Promise((done) => {
    const body = new FormData();
    body.append("files", file);
    const request = new XMLHttpRequest();
    const bar = card.querySelector("progress");
    request.upload.onprogress = (event) => {
      if (event.loaded < event.total) bar.value = event.loaded / event.total;
      else bar.removeAttribute("value"); // received; being calibrated
    };
    request.onload = () => done(show(card, request));
    request.onerror = () => done(failed(card, "The server did not answer. Is it running? Try again."));
    request.open("POST", form.action);
    request.setRequestHeader("Accept", "text/html");
    request.send(body);
  });
}

async function work() {
  if (busy) return;
  busy = true;
  while (queue.length) await send(...queue.shift());
  busy = false;
}

function take(files) {
  for (const file of files) queue.push([file, waiting(file)]);
  input.value = "";
  work();
}

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
