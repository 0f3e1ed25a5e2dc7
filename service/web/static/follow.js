// A part of a page that is still being worked on looks again by itself, and the whole page once it has ended. Where
// somebody is writing beside it, the page says that it has ended, and stays. Without this script it loads anew now and
// then.
function isWritten(field) {
  if (field.type === "checkbox" || field.type === "radio") return field.checked !== field.defaultChecked;
  return field.type !== "hidden" && field.value !== field.defaultValue;
}

function end(part) {
  if (![...document.querySelectorAll("input, textarea")].some(isWritten)) return location.reload();
  const link = document.createElement("a");
  link.href = location.href;
  link.textContent = part.dataset.saidEnded;
  part.replaceChildren(link);
}

function follow(part) {
  setTimeout(async () => {
    let next = part;
    try {
      const answer = await fetch(location.href, { headers: { Accept: "text/html" } });
      if (answer.ok) {
        const found = new DOMParser().parseFromString(await answer.text(), "text/html").querySelector("[data-follow]");
        if (!found) return end(part);
        part.replaceWith(found);
        next = found;
      }
    } catch {
      // the server does not answer just now
    }
    follow(next);
  }, 1000 * part.dataset.follow);
}

document.querySelectorAll("[data-follow]").forEach(follow);
