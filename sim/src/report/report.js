"use strict";
/* The report's pictures: zoomed and moved in step, laid over each other, with the numbers behind every pixel. The page stands without it. */
(() => {
const settings = JSON.parse(document.getElementById("settings").textContent);
const { width, height } = settings;
const el = (id) => document.getElementById(id);
const LAYERS = ["fixed", "float", "error"];
const CHANNELS = ["red", "green", "blue", "alpha"];
const BINS = 80;
const view = { zoom: 1, x: 0, y: 0, mode: "side", beat: 0 };
let values = null;

const scientific = (v) => (v === 0 ? "0" : v.toExponential(1));
const signed = (v) => (v === 0 ? "0" : (v > 0 ? "+" : "") + v.toExponential(1));
const grouped = (v) => String(v).replace(/\B(?=(\d{3})+$)/g, "\u202f");

/* --- numbers of the pixels: per channel the kernel's value in 16 bits and the error as the upper half of a single --- */

async function unpack() {
  if (!el("values")) return;
  const text = atob(el("values").textContent.trim());
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = width * height;
  const plane = (number) => planes.subarray(number * count, (number + 1) * count);
  const fixed = [], error = [];
  for (let channel = 0; channel < 4; channel += 1) {
    const [low, high, below, above] = [0, 1, 2, 3].map((part) => plane(4 * channel + part));
    fixed.push(Float32Array.from(low, (byte, i) => (byte + 256 * high[i]) / 65535));
    const words = Uint32Array.from(below, (byte, i) => (above[i] << 24) | (byte << 16));
    error.push(new Float32Array(words.buffer));
  }
  const worst = new Float32Array(count);
  for (let i = 0; i < count; i += 1) {
    for (let channel = 0; channel < 3; channel += 1) {
      if (Math.abs(error[channel][i]) > Math.abs(worst[i])) worst[i] = error[channel][i];
    }
  }
  const sizes = worst.filter((v) => v !== 0).map(Math.abs).sort();
  values = { fixed, error, worst, sizes };
}

/* --- the error's scale: as report/scale.rs has it --- */

function scaleAt(percentile) {
  const { sizes } = values;
  if (!sizes.length) return { limit: 0, knee: 0 };
  const rank = Math.min(sizes.length, Math.max(1, Math.ceil(percentile / 100 * sizes.length))) - 1;
  const limit = sizes[rank];
  const knee = 0.25 * Math.max(sizes[sizes.length >> 1], limit * 1e-8);
  return { limit, knee };
}

function colourErrors(percentile) {
  const scale = scaleAt(percentile);
  const range = Math.asinh(scale.limit / scale.knee);
  const position = (v) => (scale.limit ? Math.asinh(v / scale.knee) / range : 0);
  const shades = settings.colours, last = shades.length - 1;
  const picture = new ImageData(width, height);
  const bins = new Array(BINS + 2).fill(0);
  values.worst.forEach((error, i) => {
    const at = position(error);
    const shade = shades[Math.round((Math.min(1, Math.max(-1, at)) + 1) / 2 * last)];
    picture.data.set([...shade, 255], 4 * i);
    if (error !== 0) bins[Math.min(BINS + 1, Math.max(0, Math.floor((at + 1) / 2 * BINS) + 1))] += 1;
  });
  for (const canvas of document.querySelectorAll("canvas.error")) canvas.getContext("2d").putImageData(picture, 0, 0);
  const tick = (part) => scale.knee * Math.sinh(part * range);
  el("ticks").innerHTML = [-1, -0.5, 0, 0.5, 1].map((part) => `<span>${signed(tick(part))}</span>`).join("");
  const outliers = settings.outliers[settings.percentiles.indexOf(percentile)];
  el("outliers").textContent = scale.limit
    ? `${percentile} % of the ${grouped(values.sizes.length)} pixels that differ lie within ±${scientific(scale.limit)}; ${grouped(outliers)} beyond are in full colour, the largest at ${scientific(values.sizes.at(-1))}.`
    : "No pixel differs.";
  histogram(bins, tick);
}

function histogram(bins, tick) {
  const most = Math.log1p(Math.max(1, ...bins));
  const step = 1000 / bins.length;
  const bars = bins.map((count, bin) => {
    const tall = 100 * Math.log1p(count) / most;
    const outside = bin === 0 || bin === bins.length - 1;
    const kind = outside ? "outside" : bin <= BINS / 2 ? "darker" : "brighter";
    const edge = (b) => signed(tick((b - 1) / BINS * 2 - 1));
    const range = bin === 0 ? `below ${edge(1)}` : outside ? `above ${edge(bin)}` : `${edge(bin)} to ${edge(bin + 1)}`;
    return `<rect class="${kind}" x="${bin * step + 1}" y="${100 - tall}" width="${step - 2}" height="${tall}"><title>${grouped(count)} pixels, ${range}</title></rect>`;
  });
  el("histogram").innerHTML = bars.join("");
}

/* --- zoom and pan, in step --- */

function apply() {
  view.zoom = Math.min(64, Math.max(1, view.zoom));
  const room = 1 - 1 / view.zoom;
  view.x = Math.min(room, Math.max(0, view.x));
  view.y = Math.min(room, Math.max(0, view.y));
  for (const picture of document.querySelectorAll(".view img, .view canvas")) {
    picture.style.transform = `scale(${view.zoom}) translate(${-100 * view.x}%, ${-100 * view.y}%)`;
    const pixel = view.zoom * picture.parentElement.clientWidth / width;
    picture.style.imageRendering = pixel > 1.5 ? "pixelated" : "auto";
  }
  for (const frame of document.querySelectorAll(".view")) frame.style.touchAction = view.zoom > 1 ? "none" : "pan-y";
  el("zoomed").textContent = view.zoom > 1 ? `×${view.zoom.toFixed(1)}` : "";
}

function zoomAt(place, factor) {
  const before = view.zoom;
  view.zoom = Math.min(64, Math.max(1, view.zoom * factor));
  view.x += place[0] * (1 / before - 1 / view.zoom);
  view.y += place[1] * (1 / before - 1 / view.zoom);
  apply();
}

function listen(frame) {
  const fingers = new Map();
  const at = (event) => {
    const box = frame.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  const apart = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  frame.addEventListener("pointerdown", (event) => { fingers.set(event.pointerId, at(event)); frame.setPointerCapture(event.pointerId); read(at(event)); });
  frame.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId), place = at(event);
    if (!before) { read(place); return; }
    if (fingers.size === 2) {
      const wide = apart();
      fingers.set(event.pointerId, place);
      zoomAt(place, Math.min(1.5, Math.max(0.67, apart() / Math.max(0.01, wide))));
      return;
    }
    fingers.set(event.pointerId, place);
    if (view.mode === "slider" && view.zoom === 1) { slide(place[0]); return; }
    view.x -= (place[0] - before[0]) / view.zoom;
    view.y -= (place[1] - before[1]) / view.zoom;
    apply();
  });
  for (const end of ["pointerup", "pointercancel"]) frame.addEventListener(end, (event) => fingers.delete(event.pointerId));
  frame.addEventListener("dblclick", () => { Object.assign(view, { zoom: 1, x: 0, y: 0 }); apply(); });
  frame.addEventListener("wheel", (event) => {
    if (document.activeElement !== frame && !event.ctrlKey) return;
    event.preventDefault();
    zoomAt(at(event), Math.exp(-Math.sign(event.deltaY) * 0.2));
  }, { passive: false });
}

/* --- the pointer --- */

function read(place) {
  const x = Math.floor((view.x + place[0] / view.zoom) * width), y = Math.floor((view.y + place[1] / view.zoom) * height);
  if (!(x >= 0 && y >= 0 && x < width && y < height)) return;
  const at = y * width + x;
  if (!values) { el("pixel").innerHTML = `<tr><th>(${x}, ${y})</th><td>values of pictures beyond ${grouped(settings.most)} pixels are not kept in the page</td></tr>`; return; }
  const line = (name, digits, of) => `<tr><th>${name}</th>${CHANNELS.map((_, c) => `<td>${digits(of(c))}</td>`).join("")}</tr>`;
  const plain = (v) => v.toFixed(5);
  el("pixel").innerHTML = `<tr><th>(${x}, ${y})</th>${CHANNELS.map((name) => `<td>${name}</td>`).join("")}</tr>` +
    line(settings.engine, plain, (c) => values.fixed[c][at]) +
    line(settings.reference, plain, (c) => values.fixed[c][at] - values.error[c][at]) +
    line("error", signed, (c) => values.error[c][at]);
  for (const cross of document.querySelectorAll(".view i")) {
    cross.style.left = `${100 * ((x + 0.5) / width - view.x) * view.zoom}%`;
    cross.style.top = `${100 * ((y + 0.5) / height - view.y) * view.zoom}%`;
    cross.hidden = false;
  }
}

/* --- one over the other --- */

function layer(name) {
  const found = document.querySelector(`figure [data-layer="${name}"] img, figure [data-layer="${name}"] canvas`);
  const copy = found.cloneNode();
  if (copy.getContext) copy.getContext("2d").drawImage(found, 0, 0);
  return copy;
}

function slide(part) {
  el("divide").value = Math.round(100 * Math.min(1, Math.max(0, part)));
  clip();
}

function clip() {
  const over = el("over").querySelector("span");
  if (!over) return;
  const part = Number(el("divide").value);
  const flick = view.mode === "flicker";
  over.style.clipPath = flick ? "none" : `inset(0 0 0 ${part}%)`;
  over.style.visibility = flick && view.beat % 2 ? "hidden" : "visible";
  el("over").querySelector("b").style.left = `${part}%`;
  el("over").querySelector("b").hidden = flick;
  el("shown").textContent = flick ? (view.beat % 2 ? el("left").value : el("right").value) : `${el("left").value} | ${el("right").value}`;
}

function show(mode) {
  view.mode = mode;
  for (const button of el("modes").querySelectorAll("button[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === mode);
  const over = mode !== "side";
  el("side").hidden = over;
  el("stack").hidden = !over;
  el("divide").hidden = mode !== "slider";
  if (over) {
    const frame = el("over");
    for (const old of frame.querySelectorAll("img, canvas, span")) old.remove();
    const top = document.createElement("span");
    top.append(layer(el("right").value));
    frame.prepend(layer(el("left").value), top);
    clip();
  }
  apply();
}

/* --- plots and their rows --- */

function link() {
  const light = (row, on) => {
    for (const part of document.querySelectorAll(`[data-row="${row}"]`)) part.classList.toggle("lit", on);
  };
  for (const row of document.querySelectorAll("tr[data-row]")) {
    row.addEventListener("pointerenter", () => light(row.dataset.row, true));
    row.addEventListener("pointerleave", () => light(row.dataset.row, false));
  }
  /* Places of two designs may overlap: the nearest middle is meant, whichever lies on top. */
  for (const plot of document.querySelectorAll("svg:has(.place)")) {
    const places = [...plot.querySelectorAll(".place")];
    let shown = null;
    const pointAt = (place, event) => {
      if (shown && shown !== place) light(shown.dataset.row, false);
      shown = place;
      el("tip").hidden = !place;
      if (place) { light(place.dataset.row, true); tip(place, event); }
    };
    plot.addEventListener("pointermove", (event) => pointAt(nearest(places, event), event));
    plot.addEventListener("pointerleave", (event) => pointAt(null, event));
  }
}

/* The place whose middle is nearest to the pointer, of those that it touches. */
function nearest(places, event) {
  let best = null, least = Infinity;
  for (const place of places) {
    const box = place.getBoundingClientRect();
    const away = Math.hypot(event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2);
    if (away <= box.width / 2 && away < least) [best, least] = [place, away];
  }
  return best;
}

function tip(point, event) {
  const cells = [...document.querySelectorAll(`tr[data-row="${point.dataset.row}"] td`)].map((cell) => cell.textContent);
  const names = [...document.querySelectorAll("#designs th")].map((cell) => cell.textContent);
  const box = el("tip");
  box.replaceChildren(...names.map((name, i) => {
    const line = document.createElement("div");
    const value = document.createElement("b");
    value.textContent = cells[i] ?? "";
    line.append(name, value);
    return line;
  }));
  box.hidden = false;
  const wide = document.documentElement.clientWidth;
  box.style.left = `${Math.max(8, Math.min(wide - box.offsetWidth - 8, event.clientX + 16))}px`;
  box.style.top = `${Math.max(8, Math.min(innerHeight - box.offsetHeight - 8, event.clientY + 12))}px`;
}

async function start() {
  await unpack();
  if (values) {
    const image = document.querySelector('[data-layer="error"] img');
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height, canvas.className] = [width, height, "error"];
    image.replaceWith(canvas);
    el("percentile").addEventListener("input", () => {
      el("percent").textContent = `${settings.percentiles[el("percentile").value]} %`;
      colourErrors(settings.percentiles[el("percentile").value]);
      if (view.mode !== "side") show(view.mode);
    });
    el("percentile").value = settings.percentiles.indexOf(settings.percentile);
    el("percent").textContent = `${settings.percentile} %`;
    colourErrors(settings.percentile);
  }
  for (const part of document.querySelectorAll(".scripted")) part.hidden = part.dataset.needs === "values" && !values;
  for (const frame of document.querySelectorAll(".view")) listen(frame);
  for (const button of el("modes").querySelectorAll("button[data-mode]")) button.addEventListener("click", () => show(button.dataset.mode));
  for (const [id, factor] of [["nearer", 1.6], ["farther", 1 / 1.6]]) el(id).addEventListener("click", () => zoomAt([0.5, 0.5], factor));
  for (const id of ["left", "right"]) el(id).addEventListener("change", () => show(view.mode === "side" ? "slider" : view.mode));
  el("divide").addEventListener("input", clip);
  setInterval(() => { if (view.mode === "flicker") { view.beat += 1; clip(); } }, 450);
  addEventListener("resize", apply);
  link();
  show("side");
  document.body.dataset.ready = "yes";
  window.report = { view, apply, scaleAt, values: () => values };
}

start().catch((error) => console.error(error));
})();
