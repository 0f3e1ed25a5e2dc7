// Draws each chart when it comes near the screen: the shared specification plus the panel's own data.
const OPTIONS = {
  actions: false,
  ast: true, // expressions are interpreted, so the page needs no permission to evaluate code
  defaultStyle: false,
  renderer: "svg",
  tooltip: { disableDefaultStyle: true, theme: "custom" },
};

function draw(place) {
  const spec = JSON.parse(document.getElementById(place.dataset.spec).textContent);
  const datasets = JSON.parse(place.parentElement.querySelector("script.data").textContent);
  window.vegaEmbed(place, { ...spec, datasets: { ...spec.datasets, ...datasets } }, OPTIONS).then(
    () => place.classList.add("drawn"),
    (error) => {
      place.textContent = document.getElementById("content").dataset.saidUndrawn;
      console.error(error);
    },
  );
}

const watcher = new IntersectionObserver(
  (entries) => {
    for (const entry of entries.filter((e) => e.isIntersecting)) {
      watcher.unobserve(entry.target);
      draw(entry.target);
    }
  },
  { rootMargin: "400px" },
);

const watch = (part) => part.querySelectorAll(".chart").forEach((place) => watcher.observe(place));
watch(document);
document.addEventListener("unfolded", (event) => watch(event.target));
const isFolded = (place) => place.closest("details:not([open])");
window.addEventListener("beforeprint", () =>
  [...document.querySelectorAll(".chart:not(.drawn)")].filter((place) => !isFolded(place)).forEach(draw),
);
