"use strict";
// The page of a recording: shows what the recorder says, and asks it to act. It decides nothing by itself.
const $ = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
const CELL = 40, WHOLE = 61, WINDOW = 41, MOST_WAITING = 3;
const SIGNS = { satisfied: "✓", violated: "✗", undecided: "?" };
const ARROWS = { ArrowLeft: ["left"], ArrowRight: ["right"], ArrowUp: ["up"], ArrowDown: ["down", "none"], " ": ["none", "noop"] };
const GLYPHS = { left: "←", right: "→", up: "↑", down: "↓", none: "↓" };
let about = null, view = null, over = false, waiting = 0, chain = Promise.resolve();

function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) if (value !== null) element.setAttribute(key, value);
  element.append(...children.filter((c) => c !== null));
  return element;
}
function draw(name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text) element.textContent = text;
  return element;
}
function shown(value) {
  if (typeof value === "boolean") return String(value);
  if (typeof value === "string") return value.replace("inf", "∞");
  return String(Number(value.toPrecision(4)));
}
const real = (value) => (typeof value === "string" ? (value === "inf" ? Infinity : -Infinity) : value);

async function get(path) {
  const answer = await fetch(path, { cache: "no-store" });
  if (!answer.ok) throw new Error("the recorder refused");
  return answer.json();
}
function act(request) {
  // One after another, so that held keys arrive in order; a few may wait, more are dropped.
  if (over || waiting >= MOST_WAITING) return;
  waiting += 1;
  chain = chain.then(async () => {
    try {
      const body = JSON.stringify({ ...request, revision: view.revision });
      const answer = await fetch("act", { method: "POST", headers: { "Content-Type": "application/json" }, body });
      if (!answer.ok) throw new Error("the recorder refused");
      const before = view;
      view = await answer.json();
      if (request.do === "save" && !view.refused) $("name").value = view.name;
      show(before);
    } catch { ended(); } finally { waiting -= 1; }
  });
}

function show(before) {
  $("refused").textContent = view.refused || "";
  const told = [view.said, where(), ...changes(before)].filter(Boolean);
  $("said").textContent = view.refused ? "" : told.join(" ");
  $("count").textContent = view.samples === 1 ? "at the start" : view.samples - 1 + (view.samples === 2 ? " step" : " steps");
  $("undo").disabled = view.samples < 2;
  $("restart").disabled = view.samples < 2;
  $("save-button").disabled = view.samples < 2;
  if (!$("name").value || (before && $("name").value === before.name)) $("name").value = view.name;
  $("signals").replaceChildren(...Object.entries(view.signals).map(([name, value]) =>
    make("div", {}, make("dt", {}, name), make("dd", {}, shown(value)))));
  $("trouble").textContent = view.trouble;
  requirements();
  board();
  table();
}
function where() {
  return about.kind === "map" ? "Row " + view.state[0] + ", column " + view.state[1] + "." : "";
}
function changes(before) {
  if (!before) return [];
  return about.requirements.map(({ name }) => {
    const [old, now] = [before.requirements[name], view.requirements[name]];
    if (!old || !now || old.verdict === now.verdict) return "";
    return name + " is now " + now.verdict + ".";
  });
}

function requirements() {
  $("requirements").replaceChildren(...about.requirements.map((r) => {
    const known = view.requirements[r.name];
    const top = make("div", { class: "top" }, make("span", { class: "who" }, r.name, make("small", {}, r.strength)));
    const card = make("li", { class: "card" }, top);
    if (r.doc) card.append(make("p", {}, r.doc));
    card.append(make("code", {}, r.text));
    if (!known) return card;
    top.append(make("span", { class: "pill " + known.verdict }, make("span", { "aria-hidden": "true" }, SIGNS[known.verdict] + " "), known.verdict));
    const at = (value) => 50 + 50 * Math.tanh(real(value) / (3 * r.scale));
    const gauge = make("div", { class: "gauge", "aria-hidden": "true" }, make("i"), make("b"), make("u"));
    const [bar, , now] = gauge.children;
    bar.style.left = at(known.low) + "%";
    bar.style.width = Math.max(at(known.high) - at(known.low), 0) + "%";
    now.style.left = Math.min(Math.max(at(known.current), 1), 99) + "%";
    const range = known.low === known.high ? "exactly " + shown(known.low) : "between " + shown(known.low) + " and " + shown(known.high);
    card.append(gauge, make("p", {}, "In the end " + range + "; now " + shown(known.current)));
    return card;
  }));
}

function board() {
  const place = $("board");
  if (about.kind === "map") { place.replaceChildren(map()); return; }
  const numbers = "State: " + JSON.stringify(view.state);
  if (about.kind === "frames") {
    const image = place.querySelector("img") || place.appendChild(make("img"));
    image.src = "frame.png?" + view.revision;
    image.alt = "The environment as it renders itself. " + numbers;
  } else {
    place.replaceChildren(make("div", { class: "numbers" }, numbers));
  }
}
function map() {
  const rows = about.map.length, columns = about.map[0].length;
  const [row, column] = view.state;
  const span = (at, size) => size <= WHOLE ? [0, size] : [Math.min(Math.max(at - (WINDOW >> 1), 0), size - WINDOW), WINDOW];
  const [top, down] = span(row, rows), [left, across] = span(column, columns);
  const svg = draw("svg", { viewBox: [0, 0, across * CELL, down * CELL].join(" "), role: "img", class: view.ended ? "" : "live" });
  svg.append(draw("title", {}, "Map of " + rows + " rows and " + columns + " columns; you are at row " + row + ", column " + column));
  for (let r = top; r < top + down; r++) for (let c = left; c < left + across; c++) svg.append(...cell(r, c, (c - left) * CELL, (r - top) * CELL));
  const middle = ([r, c]) => [(c - left + 0.5) * CELL, (r - top + 0.5) * CELL];
  const inside = view.path.map(middle);
  svg.append(draw("polyline", { class: "trail", points: inside.map((p) => p.join(",")).join(" "), "pointer-events": "none" }));
  if (!view.ended) for (const [dr, dc] of [[0, -1], [1, 0], [0, 1], [-1, 0]]) {
    const [r, c] = [row + dr, column + dc];
    if (r < 0 || c < 0 || r >= rows || c >= columns) continue;
    const [x, y] = middle([r, c]);
    svg.append(draw("circle", { class: "target", cx: x, cy: y, r: CELL * 0.1, "pointer-events": "none" }));
  }
  const [x, y] = middle(view.state);
  svg.append(draw("circle", { class: "agent", cx: x, cy: y, r: CELL * 0.28, "pointer-events": "none" }));
  return svg;
}
function cell(row, column, x, y) {
  const letter = about.map[row][column];
  const box = draw("rect", { class: "cell", x, y, width: CELL, height: CELL, "data-row": row, "data-column": column });
  const parts = [box], mid = { "pointer-events": "none" };
  if (letter === "#" || letter === "H") parts.push(draw("rect", { class: "wall", x: x + 6, y: y + 6, width: CELL - 12, height: CELL - 12, rx: letter === "H" ? CELL : 4, ...mid }));
  if (letter === "S") parts.push(draw("circle", { class: "start", cx: x + CELL / 2, cy: y + CELL / 2, r: CELL * 0.34, ...mid }));
  if (letter === "G" || (letter >= "1" && letter <= "9")) {
    parts.push(draw("path", { class: "goal", d: star(x + CELL / 2, y + CELL / 2, CELL * 0.36), ...mid }));
    if (letter !== "G") parts.push(draw("text", { class: "region", x: x + 3, y: y + 13, ...mid }, letter));
  }
  if (letter >= "a" && letter <= "z") parts.push(draw("text", { class: "region", x: x + 4, y: y + 14, ...mid }, letter));
  return parts;
}
function star(x, y, radius) {
  let path = "";
  for (let k = 0; k < 10; k++) {
    const [r, a] = [k % 2 ? radius * 0.45 : radius, (Math.PI * k) / 5];
    path += (k ? "L" : "M") + (x + r * Math.sin(a)).toFixed(1) + " " + (y - r * Math.cos(a)).toFixed(1);
  }
  return path + "z";
}

function table() {
  const ranked = view.ranking.length > 0;
  $("none").hidden = view.saved.length > 0;
  $("ranking-trouble").textContent = view.ranking_trouble && !ranked ? "They cannot be scored: " + view.ranking_trouble : "";
  const head = (text, small, kind) => make("th", { scope: "col", class: kind || null }, text, small ? make("small", {}, small) : null);
  const remove = (name) => {
    const button = make("button", { type: "button", "aria-label": "Remove " + name }, "Remove");
    button.addEventListener("click", () => { if (confirm("Remove '" + name + "' from the file?")) act({ do: "remove", name }); });
    return make("td", {}, button);
  };
  const sizes = new Map(view.saved.map((d) => [d.name, d.samples]));
  let heads, rows;
  if (ranked) {
    heads = [head("Rank", "", "num"), head("Demonstration"), head("Label"), head("Reward", "", "num"), ...about.requirements.map((r) => head(r.name, r.strength)), head("", "")];
    rows = view.ranking.map((d) => make("tr", {},
      make("td", { class: "num" }, d.rank === null ? "–" : String(d.rank)),
      make("th", { scope: "row" }, d.name, ...d.reasons.map((why) => make("small", {}, why))),
      make("td", {}, make("span", { class: "label " + (d.label || "undecided") }, d.label || "undecided")),
      make("td", { class: "num" }, d.reward === null ? "–" : shown(d.reward)),
      ...d.cells.map(([verdict, value]) => make("td", { class: "verdict " + verdict }, make("span", { "aria-hidden": "true" }, SIGNS[verdict] + " "), make("span", { class: "sr" }, verdict + " "), value)),
      d.mine ? remove(d.name) : make("td")));
  } else {
    heads = [head("Demonstration"), head("Samples", "", "num"), head("", "")];
    rows = view.saved.map((d) => make("tr", {}, make("th", { scope: "row" }, d.name), make("td", { class: "num" }, String(sizes.get(d.name))), remove(d.name)));
  }
  heads[heads.length - 1].append(make("span", { class: "sr" }, "Remove"));
  $("table").hidden = rows.length === 0;
  $("table").replaceChildren(rows.length ? make("table", {}, make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...rows)) : "");
}

function key(event) {
  if (event.altKey || event.metaKey) return;
  const pressed = event.key;
  if (pressed === "Backspace" || (event.ctrlKey && pressed.toLowerCase() === "z")) { event.preventDefault(); act({ do: "undo" }); return; }
  if (event.ctrlKey) return;
  let found = (ARROWS[pressed] || []).map((name) => about.actions.find((a) => a.name === name)).find(Boolean);
  if (!found && /^[0-9]$/.test(pressed)) found = about.actions[Number(pressed)];
  if (found) { event.preventDefault(); act({ do: "act", action: found.action }); }
}
function ended() {
  if (over) return;
  over = true;
  source.close();
  $("page").inert = true;
  $("finish").disabled = true;
  const unsaved = view && view.samples > 1 ? " The unfinished one was saved too." : "";
  $("over").textContent = "The recording is over. What was recorded is in " + (about ? about.file : "the file") + "." + unsaved + " You can close this page.";
  $("over").hidden = false;
}

let source;
async function begin() {
  [about, view] = await Promise.all([get("about"), get("view")]);
  $("title").textContent = about.title || "Recording";
  document.title = (about.title || "Recording") + " · stlspec";
  $("environment").textContent = about.environment;
  $("file").textContent = about.file + (about.existing ? " (" + about.existing + " there already)" : "");
  $("live").hidden = about.requirements.length === 0;
  const clicks = about.kind === "map" ? "Click a cell next to you, or use the arrow keys. " : "";
  const slips = about.kind === "map" && !about.certain ? "The ground is slippery: a step may lead elsewhere. " : "";
  $("keys").textContent = clicks + slips + "With the board in focus: arrows or digits act, Backspace undoes.";
  $("board").setAttribute("aria-label", about.kind === "map" ? "The map" : "The environment");
  $("actions").replaceChildren(...about.actions.slice(0, 30).map((a, k) => {
    const button = make("button", { type: "button" }, a.name, make("kbd", { "aria-hidden": "true" }, GLYPHS[a.name] || String(k)));
    button.addEventListener("click", () => act({ do: "act", action: a.action }));
    return button;
  }));
  show(null);
  $("said").textContent = "";
  source = new EventSource("events");
  source.onmessage = async (event) => {
    if (Number(event.data) === view.revision || waiting) return;
    try { const before = view; view = { ...(await get("view")), refused: "", said: "Changed in another tab." }; show(before); } catch { ended(); }
  };
  source.addEventListener("end", ended);
  source.onerror = () => { if (!over) get("view").catch(ended); };
  $("board").focus();
}
$("board").addEventListener("keydown", key);
$("board").addEventListener("click", (event) => {
  const { row, column } = event.target.dataset || {};
  // The second click of a double click is not a second step.
  if (row !== undefined && event.detail < 2) act({ do: "go", row: Number(row), column: Number(column) });
});
$("undo").addEventListener("click", () => act({ do: "undo" }));
$("restart").addEventListener("click", () => act({ do: "restart" }));
$("save").addEventListener("submit", (event) => { event.preventDefault(); act({ do: "save", name: $("name").value }); $("board").focus(); });
$("finish").addEventListener("click", async () => {
  try { await fetch("finish", { method: "POST", headers: { "Content-Type": "application/json" }, body: "{}" }); } finally { ended(); }
});
begin().catch(ended);
