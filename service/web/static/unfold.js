// What a fold holds is fetched when it is opened, and at once where it stands open. Without this script, or where the
// service does not answer, its link leads to the page that holds it.
async function unfold(part) {
  try {
    const answer = await fetch(part.querySelector("a").href, { headers: { Accept: "text/html" } });
    if (!answer.ok) return;
    const found = new DOMParser().parseFromString(await answer.text(), "text/html").getElementById(part.id);
    if (!found) return;
    part.replaceWith(found);
    found.dispatchEvent(new Event("unfolded", { bubbles: true }));
  } catch {
    // the link stays
  }
}

for (const fold of document.querySelectorAll("details.fold:has(.awaited)")) {
  const look = () => fold.open && fold.querySelectorAll(".awaited").forEach(unfold);
  fold.addEventListener("toggle", look);
  look();
}
