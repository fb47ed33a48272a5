"use strict";
/* The sweep's page: filters, a scatter of any two columns, parallel axes and a table to sort. The charts above it stand without a script. */
(() => {
const data = JSON.parse(document.getElementById("points").textContent);
const el = (id) => document.getElementById(id);
const number = (text) => (text === "" ? NaN : Number(text));
const place = (name) => data.columns.indexOf(name);
const columns = data.columns.map((name, index) => {
  const texts = data.rows.map((row) => row[index]);
  const numbers = texts.map(number);
  const known = numbers.filter(Number.isFinite);
  const numeric = known.length > 0 && texts.every((text) => text === "" || Number.isFinite(Number(text)));
  const words = numeric ? [] : [...new Set(texts)].sort();
  const values = numeric ? numbers : texts.map((text) => words.indexOf(text));
  const ends = numeric ? known : values;
  const [low, high] = [ends.reduce((a, b) => Math.min(a, b), Infinity), ends.reduce((a, b) => Math.max(a, b), -Infinity)];
  const log = numeric && low > 0 && high / low > 5;
  return { name, index, numeric, words, values, low, high, log, varies: high > low, less: /^(rms|max_abs|cycles|geometry|sort|raster|area|energy_mj)$|_(luts|flip_flops|dsps|kbit)$/.test(name) };
});
const varying = columns.filter((column) => column.varies && column.name !== "point");
const rows = data.rows.map((row, index) => ({ row, index, point: Number(row[0]), front: data.front.includes(Number(row[0])) }));
const state = { sort: place("cycles"), down: false, seen: rows };

/* A value's place on an axis from 0 to 1, better towards 1 if `better`. */
function along(column, index, better) {
  let { low, high } = column, value = column.values[index];
  if (!Number.isFinite(value)) return null;
  if (column.log) [low, high, value] = [low, high, value].map(Math.log10);
  const part = high > low ? (value - low) / (high - low) : 0.5;
  return better && column.less ? 1 - part : part;
}

/* Ticks that lie among the data: decades, then 1 2 5, then all digits, then even steps of a narrow range. */
function ticks(column) {
  const { low, high } = column;
  if (!column.numeric) return column.words.map((_, i) => i);
  const few = [...new Set(column.values.filter(Number.isFinite))];
  if (few.length <= 6 && data.axes.includes(column.name)) return few;
  if (column.log) {
    for (const digits of [[1], [1, 2, 5], [1, 2, 3, 4, 5, 6, 7, 8, 9]]) {
      const found = [];
      for (let decade = Math.floor(Math.log10(low)); decade <= Math.log10(high); decade += 1) {
        found.push(...digits.map((digit) => digit * 10 ** decade).filter((v) => v >= low * 0.999 && v <= high * 1.001));
      }
      if (found.length > 3) return found.length > 9 ? found.filter((_, i) => i % Math.ceil(found.length / 9) === 0) : found;
    }
  }
  const rough = (high - low) / 7 || 1;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * decade).find((v) => v >= rough);
  const found = [];
  for (let v = Math.ceil(low / step) * step; v <= high + step * 1e-9; v += step) found.push(v);
  return found;
}

function short(v) {
  const size = Math.abs(v);
  const digits = (x) => String(Number(x.toPrecision(3)));
  if (size >= 1e9) return `${digits(v / 1e9)}G`;
  if (size >= 1e6) return `${digits(v / 1e6)}M`;
  if (size >= 1e4) return `${digits(v / 1e3)}k`;
  return size >= 0.01 || size === 0 ? digits(v) : v.toExponential(1).replace(".0", "");
}

const label = (column, tick) => (column.numeric ? short(tick) : column.words[tick] || "-");
const text = (value) => String(value).replace(/&/g, "&amp;").replace(/</g, "&lt;");

function tickPart(column, tick, better) {
  let { low, high } = column, value = tick;
  if (column.log) [low, high, value] = [low, high, value].map(Math.log10);
  const part = high > low ? (value - low) / (high - low) : 0.5;
  return better && column.less ? 1 - part : part;
}

function title(entry) {
  return text(data.columns.map((name, i) => (entry.row[i] === "" ? "" : `${name} ${entry.row[i]}`)).filter(Boolean).join("\n"));
}

/* --- scatter: better is up, and less is left, as in the report --- */

function scatter() {
  const [x, y] = [el("across"), el("up")].map((select) => columns[Number(select.value)]);
  const width = Math.min(1100, Math.max(340, el("scatter").clientWidth));
  const box = { left: 78, right: 14, top: 14, bottom: 46, width, height: 420 };
  el("scatter").setAttribute("viewBox", `0 0 ${width} ${box.height}`);
  const px = (part) => box.left + 12 + part * (box.width - box.left - box.right - 24);
  const py = (part) => box.height - box.bottom - 12 - part * (box.height - box.top - box.bottom - 24);
  const parts = [];
  for (const tick of ticks(x)) {
    const at = px(tickPart(x, tick, false));
    parts.push(`<line x1="${at}" x2="${at}" y1="${box.top}" y2="${box.height - box.bottom}"/><text x="${at}" y="${box.height - box.bottom + 17}" text-anchor="middle">${text(label(x, tick))}</text>`);
  }
  for (const tick of ticks(y)) {
    const at = py(tickPart(y, tick, true));
    parts.push(`<line x1="${box.left}" x2="${box.width - box.right}" y1="${at}" y2="${at}"/><text x="${box.left - 7}" y="${at + 4}" text-anchor="end">${text(label(y, tick))}</text>`);
  }
  parts.push(`<text x="${(box.left + box.width) / 2}" y="${box.height - 8}" text-anchor="middle">${text(x.name)}</text>`);
  parts.push(`<text transform="translate(14 ${(box.height - box.bottom) / 2}) rotate(-90)" text-anchor="middle">${text(y.name)}</text>`);
  for (const entry of [...state.seen].sort((a, b) => a.front - b.front)) {
    const [a, b] = [along(x, entry.index, false), along(y, entry.index, true)];
    if (a === null || b === null) continue;
    parts.push(`<circle class="point ${entry.front ? "front" : ""}" data-point="${entry.point}" cx="${px(a).toFixed(1)}" cy="${py(b).toFixed(1)}" r="${entry.front ? 5 : 3.5}"><title>${title(entry)}</title></circle>`);
  }
  el("scatter").innerHTML = parts.join("");
}

/* --- parallel axes: better is up on every one --- */

function parallel() {
  const chosen = varying.filter((column) => data.axes.includes(column.name) || ["psnr_db", "cycles", "area"].includes(column.name));
  const width = Math.max(320, chosen.length * 92), height = 300, top = 34, bottom = 14;
  const x = (i) => (chosen.length < 2 ? width / 2 : 46 + i * (width - 92) / (chosen.length - 1));
  const y = (part) => height - bottom - part * (height - top - bottom);
  const parts = [];
  for (const entry of [...state.seen].sort((a, b) => a.front - b.front)) {
    const line = chosen.map((column, i) => [x(i), along(column, entry.index, true)]).filter((at) => at[1] !== null);
    parts.push(`<polyline class="${entry.front ? "front" : ""}" data-point="${entry.point}" points="${line.map(([a, b]) => `${a.toFixed(1)},${y(b).toFixed(1)}`).join(" ")}"><title>${title(entry)}</title></polyline>`);
  }
  chosen.forEach((column, i) => {
    parts.push(`<line class="axis" x1="${x(i)}" x2="${x(i)}" y1="${top}" y2="${height - bottom}"/><text class="name" x="${x(i)}" y="16" text-anchor="middle">${text(column.name)}</text>`);
    for (const tick of ticks(column)) parts.push(`<text x="${x(i) + 4}" y="${y(tickPart(column, tick, true)) + 4}">${text(label(column, tick))}</text>`);
  });
  el("parallel").setAttribute("viewBox", `0 0 ${width} ${height}`);
  el("parallel").style.minWidth = `${width * 0.8}px`;
  el("parallel").innerHTML = parts.join("");
}

/* --- table --- */

function table() {
  const column = columns[state.sort];
  const shown = state.seen.filter((entry) => el("whole").checked || entry.front);
  const value = (entry) => column.values[entry.index];
  shown.sort((a, b) => {
    const [u, v] = [value(a), value(b)];
    if (Number.isNaN(u) || Number.isNaN(v)) return Number.isNaN(u) - Number.isNaN(v);
    return state.down ? v - u : u - v;
  });
  const kept = columns.filter((c) => c.varies || c.name === "point");
  const head = kept.map((c) => `<th class="${c.numeric ? "" : "word"}" aria-sort="${c.index !== state.sort ? "none" : state.down ? "descending" : "ascending"}"><button data-column="${c.index}">${text(c.name)}</button></th>`).join("");
  const body = shown.slice(0, 500).map((entry) => `<tr data-point="${entry.point}" class="${entry.front ? "front" : ""}">${kept.map((c) => `<td class="${c.numeric ? "" : "word"}">${text(entry.row[c.index])}</td>`).join("")}</tr>`).join("");
  el("table").innerHTML = `<thead><tr>${head}</tr></thead><tbody>${body}</tbody>`;
  const same = columns.filter((c) => !c.varies && data.axes.includes(c.name)).map((c) => `${c.name} ${data.rows[0]?.[c.index] ?? ""}`);
  el("count").textContent = `${shown.length} ${el("whole").checked ? "points" : "points of the front"} of ${rows.length} in all` +
    (shown.length > 500 ? ", the first 500 of them below" : "") + (same.length ? `. The same for all: ${same.join(", ")}` : "") + ".";
}

/* --- filters --- */

function filter() {
  const clock = Math.max(0, Number(el("clock").value)) * 1e6;
  const limit = (id, otherwise) => (el(id).value === "" ? otherwise : Number(el(id).value));
  const [psnr, area, rate] = [limit("least-psnr", -Infinity), limit("most-area", Infinity), limit("least-rate", 0)];
  const of = (name, entry) => (place(name) < 0 ? NaN : number(entry.row[place(name)]));
  state.seen = rows.filter((entry) => {
    const error = of("psnr_db", entry);
    /* Equal pictures have no PSNR: no error is too large for them. */
    const near = Number.isNaN(error) || error >= psnr;
    return near && !(of("area", entry) > area) && !(clock / of("cycles", entry) < rate);
  });
  const seen = new Set(state.seen.map((entry) => String(entry.point)));
  for (const mark of document.querySelectorAll(".still circle")) mark.classList.toggle("out", !seen.has(mark.dataset.point));
  draw();
}

function draw() {
  scatter();
  parallel();
  table();
}

function light(point, on) {
  for (const mark of document.querySelectorAll(`[data-point="${point}"]`)) mark.classList.toggle("lit", on);
}

function start() {
  const options = (chosen) => varying.map((column) => `<option value="${column.index}"${column.name === chosen ? " selected" : ""}>${text(column.name)}</option>`).join("");
  const has = (name) => varying.some((column) => column.name === name);
  el("across").innerHTML = options("cycles");
  el("up").innerHTML = options(has("psnr_db") ? "psnr_db" : "area");
  for (const id of ["across", "up"]) el(id).addEventListener("change", scatter);
  for (const id of ["least-psnr", "most-area", "least-rate", "clock"]) el(id).addEventListener("input", filter);
  el("whole").addEventListener("change", table);
  addEventListener("resize", scatter);
  el("table").addEventListener("click", (event) => {
    const button = event.target.closest("button[data-column]");
    if (!button) return;
    const column = Number(button.dataset.column);
    [state.down, state.sort] = [column === state.sort && !state.down, column];
    table();
  });
  for (const [kind, on] of [["pointerover", true], ["pointerout", false]]) {
    document.addEventListener(kind, (event) => {
      const mark = event.target.closest?.("[data-point]");
      if (mark) light(mark.dataset.point, on);
    });
  }
  for (const part of document.querySelectorAll(".scripted")) part.hidden = false;
  el("plain").hidden = true;
  filter();
  document.body.dataset.ready = "yes";
}

start();
})();
