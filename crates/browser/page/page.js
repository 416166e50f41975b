// The page: what is chosen becomes a deck, a worker runs it, and what it tells is drawn.
"use strict";
const $ = (id) => document.getElementById(id);
const example = $("example").textContent;
// In all digits, which are read back to the same number.
const exact = (x) => (x === null || x === undefined ? "–" : String(x));
const short = (x, digits = 3) => {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e-3 && size < 1e6) return String(Number(x.toPrecision(digits)));
  const [mantissa, power] = x.toExponential(digits - 1).split("e");
  return `${mantissa} · 10${[...power.replace("+", "")].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"["0123456789-".indexOf(c)]).join("")}`;
};
const METHODS = {
  exact: "",
  "gauss-seidel": '[solver]\ncontact = "gauss-seidel"\n',
  uzawa: '[solver]\ncontact = "uzawa"\n',
  outside: '[solver]\ncontact = "uzawa"\nnesting = "outside"\n',
  penalty: "[solver]\ncontact = { penalty = { normal = 1e7, tangent = 1e7 } }\n",
};

// What is chosen.
const chosen = () => {
  const n = Number($("cells").value);
  return { friction: Number($("friction").value), cells: [10 * n, 2 * n], algorithm: $("algorithm").value };
};

// An address may end in a choice, as in #friction=0.2&cells=3&algorithm=uzawa: what is no choice is left aside.
const CHOICES = ["friction", "cells", "algorithm"];
function recall() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  for (const id of CHOICES.filter((id) => wanted.has(id))) {
    const before = $(id).value;
    $(id).value = wanted.get(id);
    if ($(id).value === "") $(id).value = before;
  }
}

// The example with what is chosen in it: what it expects holds for its own numbers alone.
const deckOf = ({ friction, cells, algorithm }) =>
  example
    .replace(/^cells = .*$/m, `cells = [${cells.join(", ")}]`)
    .replace(/^friction = .*$/m, `friction = ${friction}`)
    .replace(/^\[expect\][^]*$/m, METHODS[algorithm])
    .trimEnd() + "\n";

const show = () => {
  const { friction, cells } = chosen();
  $("friction-shown").textContent = friction.toFixed(2);
  $("cells-shown").textContent = `${cells[0]} × ${cells[1]}`;
};

// One run at a time: another choice ends it.
let module, worker, states = [], outcome = null, deck = "";
const modulePromise = (async () => {
  const packed = Uint8Array.from(atob($("module").textContent.trim()), (c) => c.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  module = await WebAssembly.compile(await new Response(unpacked).arrayBuffer());
})();
const source = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));

// One sentence in the colour of what is wrong, and below it what is more.
const say = (text, wrong = false, more = "") => {
  $("state").textContent = text;
  $("state").className = wrong ? "wrong" : "";
  $("more").textContent = more;
};

async function run() {
  show();
  worker?.terminate();
  document.documentElement.dataset.state = "running";
  deck = deckOf(chosen());
  $("deck").textContent = deck;
  say("computing …");
  try {
    await modulePromise;
  } catch (error) {
    end("failed", String(error), true);
    return;
  }
  worker?.terminate();
  worker = new Worker(source);
  const fresh = [];
  worker.onmessage = ({ data }) => {
    if (data.kind === "increment") {
      fresh.push(JSON.parse(data.text));
      [states, outcome] = [fresh, null];
      say(`increment ${fresh.length} …`);
      follow();
    } else if (data.kind === "outcome") {
      outcome = JSON.parse(data.text);
      [states] = [fresh];
      const whole = outcome.status === "done";
      const warned = outcome.warnings.map((w) => `Note: ${w}`);
      const [what, ...why] = (outcome.error ?? "").split(/(?<=\.) (?=[A-Z])/);
      const took = `${outcome.increments} increments in ${short(data.computing / 1000, 3)} s`;
      follow();
      const more = [why.join(" "), ...warned].join("\n").trim();
      end(outcome.status, whole ? took : `${outcome.status}: ${what}`, !whole, more);
    } else {
      end(data.kind, data.text, true);
    }
  };
  worker.onerror = (event) => end("failed", event.message, true);
  worker.postMessage({ module, deck });
}

function end(state, text, wrong = false, more = "") {
  say(text, wrong, more);
  document.documentElement.dataset.state = state;
}

// The last increment is shown as long as nobody looks at another.
let asked = false;
function follow() {
  const slider = $("increment");
  slider.max = Math.max(1, states.length);
  if (!asked) slider.value = slider.max;
  requestDraw();
}

// At most once a frame, and also where no frames are drawn.
let waiting = null;
function requestDraw() {
  waiting ??= setTimeout(() => {
    waiting = null;
    draw();
  }, 15);
}

function draw() {
  const state = states[Math.min(states.length, Number($("increment").value)) - 1];
  if (!state) return;
  $("increment-shown").textContent = `${$("increment").value} of ${states.length}`;
  body(state);
  contact(state);
  course(state);
  numbers(state);
}

// Colours that the eye orders, and that are told apart without red and green.
const STOPS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
  [170, 220, 50], [253, 231, 37]];
const colour = (t) => {
  const at = Math.min(Math.max(t, 0), 1) * (STOPS.length - 1), k = Math.min(Math.floor(at), STOPS.length - 2);
  return `rgb(${STOPS[k].map((a, i) => Math.round(a + (at - k) * (STOPS[k + 1][i] - a))).join(",")})`;
};
$("colours").style.background = `linear-gradient(90deg, ${STOPS.map((s) => `rgb(${s})`).join(",")})`;

// Shape functions of a quadrilateral with eight nodes, corners first.
const CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]], MIDDLES = [[0, -1], [1, 0], [0, 1], [-1, 0]];
const shapes = (x, y) => [
  ...CORNERS.map(([a, b]) => 0.25 * (1 + a * x) * (1 + b * y) * (a * x + b * y - 1)),
  ...MIDDLES.map(([a, b]) => (a === 0 ? 0.5 * (1 - x * x) * (1 + b * y) : 0.5 * (1 + a * x) * (1 - y * y))),
];
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// How many times displacements are drawn: so that they are seen, in whole steps of 1, 2 and 5.
const magnification = () => {
  const last = states[states.length - 1].fields.displacement;
  const largest = last.reduce((m, v) => Math.max(m, Math.abs(v)), 1e-12);
  const wanted = 2.5 / largest, power = 10 ** Math.floor(Math.log10(wanted));
  return Math.max(1, power * [5, 2, 1].find((f) => f * power <= wanted));
};

function values(state) {
  const name = $("field").value, all = state.fields[name];
  if (name !== "displacement") return [all, name === "von_mises" ? "MPa" : ""];
  return [state.points.map((_, k) => Math.hypot(all[3 * k], all[3 * k + 1])), "mm"];
}

function body(state) {
  const canvas = $("body"), width = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
  const times = magnification(), [field, unit] = values(state), u = state.fields.displacement;
  const at = state.points.map(([x, y], k) => [x + times * u[3 * k], y + times * u[3 * k + 1]]);
  // Room for the longest arrow below, and for the body as it bulges.
  const sides = [-1, 57], under = -9, over = 22.5;
  const scale = width / (sides[1] - sides[0]), height = scale * (over - under);
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  canvas.style.height = `${height}px`;
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const place = ([x, y]) => [(x - sides[0]) * scale, (over - y) * scale];
  const least = Math.min(...field), most = Math.max(...field), range = most - least || 1;
  const count = state.cells.length, parts = count > 300 ? 2 : count > 80 ? 4 : 8;
  const grid = [];
  for (let j = 0; j <= parts; j++)
    for (let i = 0; i <= parts; i++) grid.push(shapes((2 * i) / parts - 1, (2 * j) / parts - 1));
  const centres = [];
  for (let j = 0; j < parts; j++)
    for (let i = 0; i < parts; i++) centres.push(shapes((2 * i + 1) / parts - 1, (2 * j + 1) / parts - 1));
  const sum = (N, cell, of) => N.reduce((s, n, k) => s + n * of(cell[k]), 0);
  for (const cell of state.cells) {
    const points = grid.map((N) => place([sum(N, cell, (p) => at[p][0]), sum(N, cell, (p) => at[p][1])]));
    for (let j = 0; j < parts; j++)
      for (let i = 0; i < parts; i++) {
        const a = j * (parts + 1) + i, corners = [a, a + 1, a + parts + 2, a + parts + 1];
        const value = sum(centres[j * parts + i], cell, (p) => field[p]);
        pen.beginPath();
        corners.forEach((c) => pen.lineTo(...points[c]));
        pen.closePath();
        pen.fillStyle = pen.strokeStyle = colour((value - least) / range);
        // A hair wider, so that no gap shines through.
        pen.lineWidth = 0.7;
        pen.fill();
        pen.stroke();
      }
  }
  pen.strokeStyle = "rgba(255, 255, 255, .35)";
  pen.lineWidth = state.cells.length > 300 ? 0.35 : 0.7;
  for (const [a, b, c, d, e, f, g, h] of state.cells) {
    pen.beginPath();
    [a, e, b, f, c, g, d, h, a].forEach((p) => pen.lineTo(...place(at[p])));
    pen.stroke();
  }
  rigid(pen, place([sides[0], 0]), place([sides[1], 0]), 1);
  const top = 20 + times * state.history["u.punch.y"];
  rigid(pen, place([0, top]), place([25, top]), -1);
  arrows(pen, place, state, times);
  $("least").textContent = short(least);
  $("most").textContent = `${short(most)} ${unit}`.trim();
  $("body-note").textContent = `Displacements ${short(times)} times as large; arrows are the forces of the foundation on ` +
    "the block. The left side is the plane of symmetry; the punch is above, the foundation below.";
}

// The face of something rigid, with strokes on the side of it: 1 below, -1 above.
function rigid(pen, [from, y], [to], side) {
  pen.strokeStyle = css("--ink");
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(from, y);
  pen.lineTo(to, y);
  pen.stroke();
  pen.lineWidth = 0.8;
  pen.beginPath();
  for (let x = from + 6; x <= to; x += 7) {
    pen.moveTo(x, y);
    pen.lineTo(x - 6, y + 6 * side);
  }
  pen.stroke();
}

const STATUS = { stick: "--stick", slip: "--slip", open: "--open" };

function arrows(pen, place, state, times) {
  const { x, x_now, t_n, t_1, status } = state.contacts;
  const largest = Math.max(...states[states.length - 1].contacts.t_n.map(Math.abs), 1e-12);
  pen.lineWidth = 1.6;
  x.forEach((_, k) => {
    if (status[k] === "open") return;
    const foot = x[k] + times * (x_now[k] - x[k]);
    // From below the force points to the body, inclined by friction.
    const [fx, fy] = [(6.5 * shear(state, k)) / largest, (6.5 * t_n[k]) / largest];
    const [tail, tip] = [place([foot - fx, -fy - 0.4]), place([foot, -0.4])];
    pen.strokeStyle = pen.fillStyle = css(STATUS[status[k]]);
    pen.beginPath();
    pen.moveTo(...tail);
    pen.lineTo(...tip);
    pen.stroke();
    const long = Math.hypot(tip[0] - tail[0], tip[1] - tail[1]);
    if (long < 4) return;
    const [dx, dy] = [(tip[0] - tail[0]) / long, (tip[1] - tail[1]) / long];
    pen.beginPath();
    pen.moveTo(...tip);
    pen.lineTo(tip[0] - 5 * dx - 2.5 * dy, tip[1] - 5 * dy + 2.5 * dx);
    pen.lineTo(tip[0] - 5 * dx + 2.5 * dy, tip[1] - 5 * dy - 2.5 * dx);
    pen.fill();
  });
}

// Force along x: the first tangent of a floor seen from above.
const shear = (state, k) => state.contacts.t_1[k];

// A chart in a box of 400 by 210, its axes labelled at round numbers.
function chart(xs, ys, [xLabel, yLabel], draw) {
  const [l, r, t, b] = [62, 390, 12, 172];
  const ticks = (least, most) => {
    const step = 10 ** Math.floor(Math.log10((most - least) / 4));
    const by = step * [1, 2, 5, 10].find((f) => (most - least) / (f * step) <= 5);
    const list = [];
    for (let v = Math.ceil(least / by - 1e-9); v * by <= most * (1 + 1e-9) + 1e-300; v++) list.push(v * by);
    return list;
  };
  const range = (all) => {
    const [least, most] = [Math.min(0, ...all), Math.max(0, ...all)];
    return most > least ? [least, most] : [0, 1];
  };
  // With room above for what is written there.
  const [x0, x1] = range(xs), [y0, y1] = range([...ys, 1.15 * Math.max(0, ...ys)]);
  const X = (x) => l + ((x - x0) / (x1 - x0)) * (r - l), Y = (y) => b - ((y - y0) / (y1 - y0)) * (b - t);
  const grid = ticks(y0, y1).map((v) =>
    `<line x1="${l}" x2="${r}" y1="${Y(v)}" y2="${Y(v)}" stroke="var(--rule)"/>` +
    `<text x="${l - 6}" y="${Y(v) + 4}" text-anchor="end">${short(v)}</text>`);
  const marks = ticks(x0, x1).map((v) => `<text x="${X(v)}" y="${b + 17}" text-anchor="middle">${short(v)}</text>`);
  return `<svg viewBox="0 0 400 210" role="img" aria-label="${yLabel} over ${xLabel}">${grid.join("")}${marks.join("")}
    <text x="${(l + r) / 2}" y="206" text-anchor="middle">${xLabel}</text>
    <text transform="translate(11 ${(t + b) / 2}) rotate(-90)" text-anchor="middle">${yLabel}</text>
    ${draw(X, Y)}</svg>`;
}

const path = (points, style) => `<path d="M${points.map((p) => p.join(" ")).join("L")}" fill="none" ${style}/>`;

function contact(state) {
  const { x, p_n, p_1, status } = state.contacts, friction = Number(/^friction = (.*)$/m.exec(deck)[1]);
  const order = x.map((_, k) => k).sort((a, b) => x[a] - x[b]);
  const all = [...p_n, ...p_1];
  $("contact").innerHTML = chart(x, all, ["x [mm]", "traction [MPa]"], (X, Y) => {
    const line = (of, style) => path(order.map((k) => [X(x[k]), Y(of(k))]), style);
    const dots = (of, radius) =>
      order.map((k) => `<circle cx="${X(x[k])}" cy="${Y(of(k))}" r="${radius}" fill="var(${STATUS[status[k]]})"/>`).join("");
    const far = order[order.length - 1];
    const sign = order.some((k) => p_1[k] < 0) ? -1 : 1;
    const name = (k, y, text) => `<text x="${X(x[k]) + 4}" y="${y}" text-anchor="start">${text}</text>`;
    return line((k) => sign * friction * p_n[k], 'stroke="var(--faint)" stroke-dasharray="5 4"') +
      line((k) => p_n[k], 'stroke="var(--faint)" stroke-width="1.5"') + dots((k) => p_n[k], 3.5) +
      line((k) => p_1[k], 'stroke="var(--faint)" stroke-width="1"') + dots((k) => p_1[k], 2.5) +
      name(order[0], Y(p_n[order[0]]) - 8, "pressure") + (friction > 0 ? name(order[0], Y(0) - 6, "shear") : "");
  });
}

function course(state) {
  const down = states.map((s) => -s.history["u.punch.y"]), load = states.map((s) => -s.history["force.punch.y"]);
  const at = states.indexOf(state);
  $("course").innerHTML = chart([0, ...down], [0, ...load], ["punch down [mm]", "load [N/mm]"], (X, Y) =>
    path([[X(0), Y(0)], ...down.map((d, k) => [X(d), Y(load[k])])], 'stroke="var(--accent)" stroke-width="2"') +
    `<circle cx="${X(down[at])}" cy="${Y(load[at])}" r="4.5" fill="var(--accent)"/>`);
  const shown = state.history["force.punch.y"];
  $("load").textContent = shown.toFixed(2).replace("-", "−");
  $("load").title = $("load").dataset.value = exact(shown);
}

const rows = (id, list) => {
  $(id).innerHTML = list.map(([name, value]) => `<dt>${name}</dt><dd>${value}</dd>`).join("");
};

function numbers(state) {
  const h = state.history, worst = (name) => states.reduce((m, s) => Math.max(m, s.history[name] ?? 0), 0);
  const relative = outcome?.certificate?.relative_gap;
  rows("certificate", [
    ["gap of the bipotential", `${short(outcome?.certificate?.bipotential_gap ?? worst("bipotential_gap"))} N·mm`],
    ["in parts of the work done", outcome ? short(relative) : "…"],
    ["penetration", `${short(worst("penetration"))} mm`],
    ["force outside of the cone", `${short(worst("excess_force"))} N`],
    ["out of balance", `${short(worst("out_of_balance"))} N`],
  ]);
  rows("effort", [
    ["work of the punch", `${short(h.external_work, 6)} N·mm`],
    ["stored", `${short(h.elastic_energy, 6)} N·mm`],
    ["plastic flow", `${short(h.plastic_dissipation, 6)} N·mm`],
    ["friction", `${short(h.friction_dissipation, 6)} N·mm`],
    ...(h.penalty_energy ? [["springs of the penalty", `${short(h.penalty_energy, 6)} N·mm`]] : []),
    ["Newton iterations", states.reduce((s, t) => s + t.history.newton_iterations, 0)],
    ["iterations for contact", states.reduce((s, t) => s + t.history.contact_iterations, 0)],
    ["contact points that stick", h.stick],
    ["that slip", h.slip],
    ["that are open", h.open],
    ["that symmetry holds along the foundation", state.contacts.x.length - h.stick - h.slip - h.open],
  ]);
}

let pause = null;
const soon = () => {
  show();
  clearTimeout(pause);
  pause = setTimeout(() => {
    history.replaceState(null, "", `#${CHOICES.map((id) => `${id}=${$(id).value}`).join("&")}`);
    run();
  }, 120);
};
for (const id of CHOICES) $(id).addEventListener("input", soon);
$("choice").addEventListener("submit", (event) => event.preventDefault());
$("field").addEventListener("input", requestDraw);
$("increment").addEventListener("input", () => {
  asked = $("increment").value !== $("increment").max;
  requestDraw();
});
new ResizeObserver(requestDraw).observe($("body"));
recall();
run();
