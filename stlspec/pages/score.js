"use strict";
// Everything can be read without this: it filters, unfolds, and opens what a link of the table leads to.
const demonstrations = [...document.querySelectorAll("details")];
const open = () => {
  const target = location.hash ? document.getElementById(location.hash.slice(1)) : null;
  if (target instanceof HTMLDetailsElement) { target.open = true; target.scrollIntoView(); target.querySelector("summary").focus(); }
};
addEventListener("hashchange", open);
open();
const all = document.getElementById("all");
if (all) {
  all.hidden = false;
  all.addEventListener("click", () => {
    const folded = demonstrations.some((d) => !d.open);
    for (const d of demonstrations) d.open = folded;
    all.textContent = folded ? "Fold all" : "Unfold all";
  });
}
const filter = document.getElementById("filter");
if (filter) {
  filter.parentElement.hidden = false;
  const rows = [...document.querySelectorAll("#ranking tbody tr")].map((row) => [row, row.textContent.toLowerCase()]);
  const told = document.getElementById("found");
  filter.addEventListener("input", () => {
    const wanted = filter.value.trim().toLowerCase();
    let shown = 0;
    for (const [row, text] of rows) { row.hidden = !text.includes(wanted); shown += row.hidden ? 0 : 1; }
    told.textContent = wanted ? shown + " of " + rows.length + " shown" : "";
  });
}
addEventListener("beforeprint", () => { for (const d of demonstrations) d.open = true; });
