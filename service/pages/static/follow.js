// A part of a page that is still being worked on looks again by itself, and the whole page once it has ended.
// Without this script the page loads anew now and then. What somebody is writing beside it stays.
function follow(part) {
  setTimeout(async () => {
    let next = part;
    try {
      const answer = await fetch(location.href, { headers: { Accept: "text/html" } });
      if (answer.ok) {
        const found = new DOMParser().parseFromString(await answer.text(), "text/html").querySelector("[data-follow]");
        if (!found) return location.reload();
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
