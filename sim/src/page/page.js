"use strict";
// The live page: a camera to turn, widths to change, and what both do to the picture. The wasm draws; this script moves
// bytes and listens.

const settings = JSON.parse(document.getElementById("settings").textContent);
const el = (id) => document.getElementById(id);
const LAYERS = ["fixed", "float", "error"];
const FIGURES = ["psnr", "largest", "bias", "x", "y", "psnrCovered", "biasCovered", "visited", "covered", "drawn", "culled",
  "checksumHigh", "checksumLow", "limit", "knee", "outliers"];
const BINS = 64;
// A view that is being turned is drawn at least so often: by the kernel alone, and smaller, if need be.
const SLOW_MS = 100;

let wasm, camera, target, home, design;
const state = { moving: false, alone: false, whole: 0, kernel: 0, timer: 0, camera: true, design: true, limit: 0, pointer: null };

// --- bytes of the page ---

async function unpacked(id) {
  const text = atob(el(id).textContent.trim());
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function start() {
  const module = await WebAssembly.instantiate(await unpacked("wasm"), {});
  wasm = module.instance.exports;
  const scene = await unpacked("scene");
  const place = wasm.input(scene.length);
  new Uint8Array(wasm.memory.buffer, place, scene.length).set(scene);
  if (wasm.load() !== settings.splats) throw new Error("the scene in this page is damaged");
  home = cameraOf(settings.camera);
  reset();
  build();
  choose(settings.design);
  compareWithHost();
  point([0.5, 0.5]);
  document.body.dataset.ready = "yes";
}

// --- camera ---

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, f) => [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const length = Math.sqrt(dot(a, a)); return a.map((v) => v / length); };

function cameraOf(numbers) {
  const n = numbers.map((v) => (v === null ? Infinity : v));
  return { size: [n[0], n[1]], focal: [n[2], n[3]], centre: [n[4], n[5]], rows: [n.slice(6, 9), n.slice(9, 12), n.slice(12, 15)],
    shift: n.slice(15, 18), near: n[18], far: n[19], parallel: n[20] };
}

const eyeOf = (c) => [0, 1, 2].map((i) => -(c.rows[0][i] * c.shift[0] + c.rows[1][i] * c.shift[1] + c.rows[2][i] * c.shift[2]));

function place(c, eye) {
  c.shift = c.rows.map((row) => -dot(row, eye));
}

function reset() {
  camera = structuredClone(home);
  target = settings.target.slice();
  state.camera = true;
}

function turned(vector, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const along = dot(vector, axis) * (1 - c);
  const side = cross(axis, vector);
  return [0, 1, 2].map((i) => vector[i] * c + side[i] * s + axis[i] * along);
}

function orbit(across, down) {
  const offset = add(eyeOf(camera), target, -1);
  const turn = (v) => turned(turned(v, settings.up, -across), camera.rows[0], -down);
  const eye = add(target, turn(offset), 1);
  const forward = unit(turn(camera.rows[2]));
  const right = unit(cross(turn(camera.rows[1]), forward));
  camera.rows = [right, cross(forward, right), forward];
  place(camera, eye);
  moved();
}

function zoom(factor) {
  if (camera.parallel) camera.focal = camera.focal.map((f) => f / factor);
  else place(camera, add(target, add(eyeOf(camera), target, -1), factor));
  moved();
}

function pan(across, down) {
  const distance = camera.parallel ? 1 : Math.abs(dot(add(target, eyeOf(camera), -1), camera.rows[2]));
  const step = add(camera.rows[0].map((v) => -v * across * distance / camera.focal[0]), camera.rows[1], -down * distance / camera.focal[1]);
  const eye = add(eyeOf(camera), step, 1);
  target = add(target, step, 1);
  place(camera, eye);
  moved();
}

function moved() {
  state.camera = true;
  state.moving = true;
  clearTimeout(state.timer);
  state.timer = setTimeout(() => { state.moving = false; state.camera = true; request(); }, 160);
  request();
}

function writeCamera(part) {
  const numbers = [...camera.size.map((s) => Math.max(1, Math.round(s * part))), ...camera.focal.map((f) => f * part),
    ...camera.centre.map((c) => c * part), ...camera.rows.flat(), ...camera.shift, camera.near, camera.far, camera.parallel];
  new Float64Array(wasm.memory.buffer, wasm.camera_numbers(), numbers.length).set(numbers);
  return numbers;
}

// --- drawing ---

let requested = false;
function request() {
  if (requested) return;
  requested = true;
  requestAnimationFrame(() => { requested = false; frame(); });
}

function frame() {
  // A view that moves, and takes long: the kernel alone, the reference when it rests; smaller, if even that takes long.
  const alone = state.moving && state.whole > SLOW_MS;
  const part = !alone || state.kernel <= SLOW_MS ? 1 : state.kernel > 4 * SLOW_MS ? 0.25 : 0.5;
  const anew = state.camera || state.alone;
  if (!anew && !state.design) return;
  state.alone = alone;
  const [width, height] = writeCamera(part);
  new Uint8Array(wasm.memory.buffer, wasm.design_bytes(), 15).set([...design.widths, design.rounding, design.traversal]);
  const started = performance.now();
  let wrong = wasm.draw(1);
  const fixedAt = performance.now();
  if (!wrong && anew && !alone) wrong = wasm.draw(2);
  if (wrong === 3) {
    // Each slider keeps its own range; what two widths rule out together is said, and the picture stays.
    el("times").textContent = "not drawn: a table has at most radial + 2 bits, and ties to even leave the accumulator at most 23";
    state.design = false;
    return;
  }
  if (wrong) throw new Error(["", "no scene", "this camera cannot be drawn"][wrong]);
  const floatAt = performance.now();
  if (!alone) wasm.compare(settings.percentile, el("hold").checked ? state.limit : 0);
  show(alone ? ["fixed"] : LAYERS, width, height);
  const ended = performance.now();
  document.body.classList.toggle("moving", alone);
  state.camera = state.design = false;
  if (part === 1) state.kernel = fixedAt - started;
  if (!alone && anew) state.whole = ended - started;
  el("times").textContent = `${width} × ${height}: fixed ${(fixedAt - started).toFixed(0)} ms` + (alone ? ", float when the view rests" :
    (anew ? `, float ${(floatAt - fixedAt).toFixed(0)} ms` : "") + `, error ${(ended - floatAt).toFixed(0)} ms`);
}

function show(layers, width, height) {
  for (const name of layers) {
    const canvas = el(name);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const bytes = new Uint8ClampedArray(wasm.memory.buffer, wasm.pixels(LAYERS.indexOf(name)), width * height * 4);
    canvas.getContext("2d").putImageData(new ImageData(bytes.slice(), width, height), 0, 0);
  }
  const f = figures();
  el("visited").textContent = grouped(f.visited);
  el("ratio").textContent = f.covered ? (f.visited / f.covered).toFixed(2) : "-";
  el("drawn").textContent = `${grouped(f.drawn)} of ${grouped(settings.splats)} splats drawn`;
  if (layers.length < LAYERS.length) return;
  state.limit = f.limit;
  el("psnr").textContent = f.psnr === Infinity ? "identical" : f.psnr.toFixed(2);
  el("largest").textContent = scientific(f.largest);
  el("bias").textContent = signed(f.bias);
  el("covered").textContent = f.psnrCovered === Infinity ? "identical" : f.psnrCovered.toFixed(2);
  el("scale").textContent = f.limit ? `full colour at ±${scientific(f.limit)}, ${grouped(f.outliers)} pixels beyond` : "no error";
  drawHistogram(f);
  readPointer();
}

function figures() {
  const numbers = new Float64Array(wasm.memory.buffer, wasm.figures(), FIGURES.length);
  return Object.fromEntries(FIGURES.map((name, i) => [name, numbers[i]]));
}

function checksum() {
  const f = figures();
  return [f.checksumHigh, f.checksumLow].map((v) => v.toString(16).padStart(8, "0")).join("");
}

// The first picture is that of the host's camera and design: the host's kernel wrote its checksum beside the scene.
function compareWithHost() {
  frame();
  const same = checksum() === settings.checksum;
  document.body.dataset.same = same ? "yes" : "no";
  el("same").textContent = same ? "same bits as the host" : "NOT the host's bits";
  el("same").title = `checksum of the first picture's integers: ${checksum()}, the host's: ${settings.checksum}`;
  el("same").className = same ? "good" : "bad";
}

// --- the pointer ---

const scientific = (v) => (v === 0 ? "0" : v.toExponential(1));
const signed = (v) => (v === 0 ? "0" : (v > 0 ? "+" : "") + v.toExponential(1));
const grouped = (v) => String(v).replace(/\B(?=(\d{3})+$)/g, "\u202f");

function readPointer() {
  if (!state.pointer || state.alone) return;
  const canvas = el("fixed");
  const x = Math.min(canvas.width - 1, Math.floor(state.pointer[0] * canvas.width));
  const y = Math.min(canvas.height - 1, Math.floor(state.pointer[1] * canvas.height));
  const row = (name, layer, digits) => `<tr><th>${name}</th>` +
    [0, 1, 2, 3].map((channel) => `<td>${digits(wasm.value(layer, channel, x, y))}</td>`).join("") + "</tr>";
  const plain = (v) => v.toFixed(9);
  el("values").innerHTML = `<tr><th>(${x}, ${y})</th><td>red</td><td>green</td><td>blue</td><td>alpha</td></tr>` +
    row("fixed", 0, plain) + row("float", 1, plain) + row("error", 2, signed);
  for (const name of LAYERS) {
    const cross = el(name).nextElementSibling;
    cross.style.left = `${100 * (x + 0.5) / canvas.width}%`;
    cross.style.top = `${100 * (y + 0.5) / canvas.height}%`;
    cross.hidden = false;
  }
  readPacket(wasm.pick(x, y));
}

function readPacket(splat) {
  if (splat < 0) {
    el("packet").innerHTML = "";
    el("picked").textContent = "No splat covers this pixel.";
    return;
  }
  const bytes = new Uint8Array(wasm.memory.buffer, wasm.text(), wasm.text_length());
  const packet = JSON.parse(new TextDecoder().decode(bytes.slice()));
  el("picked").textContent = `Splat ${grouped(splat)} takes ${(100 * packet.share).toPrecision(3)} % of the light: ${ordinal(packet.place)} from ` +
    `the front of ${packet.covering} that cover the pixel. ${packet.bits} bits in ${packet.words} words.`;
  el("packet").innerHTML = "<tr><th>field</th><th>bit</th><th>bits</th><th>value</th></tr>" + packet.fields.map((field) => {
    let value = BigInt("0b" + field.bits);
    if (field.signed && field.bits[0] === "1") value -= 1n << BigInt(field.width);
    const shown = field.fraction ? (Number(value) / 2 ** field.fraction).toPrecision(8) : String(value);
    const parts = field.bits.length - field.fraction;
    const mark = field.fraction ? nibbles(field.bits.slice(0, parts)) + "<i>.</i>" + nibbles(field.bits.slice(parts), true) : nibbles(field.bits);
    return `<tr><td>${field.name}</td><td>${field.offset}</td><td class="bits">${mark}</td><td>${shown}</td></tr>`;
  }).join("");
}

// In fours, counted from the binary point.
function nibbles(bits, forward) {
  const first = forward ? 4 : bits.length % 4 || 4;
  const groups = bits ? [bits.slice(0, first)] : [];
  for (let i = first; i < bits.length; i += 4) groups.push(bits.slice(i, i + 4));
  return groups.join("\u200a<wbr>");
}

const ordinal = (n) => n + (["th", "st", "nd", "rd"][n % 100 > 10 && n % 100 < 14 ? 0 : n % 10] || "th");

function listen(canvas) {
  const fingers = new Map();
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  canvas.addEventListener("pointerdown", (event) => {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
    point(at(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) { if (event.pointerType === "mouse") point(at(event)); return; }
    const [across, down] = [event.clientX - before[0], event.clientY - before[1]];
    const size = canvas.clientWidth;
    if (fingers.size === 2) {
      const apart = spread();
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      zoom(Math.min(2, Math.max(0.5, apart / Math.max(1, spread()))));
      pan(across / 2 * camera.size[0] / size, down / 2 * camera.size[0] / size);
      return;
    }
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.shiftKey || event.buttons === 2) pan(across * camera.size[0] / size, down * camera.size[0] / size);
    else orbit(across / size * 3.2, down / size * 3.2);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(Math.sign(event.deltaY) * 0.08)); }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, -0.05], ArrowDown: [0, 0.05] }[event.key];
    if (step) { event.preventDefault(); orbit(...step); }
    if (event.key === "+" || event.key === "-") zoom(event.key === "+" ? 0.93 : 1.07);
  });
}

function point(place) {
  if (!place.every((part) => part >= 0 && part < 1)) return;
  state.pointer = place;
  if (!requested) readPointer();
}

// --- histogram ---

function drawHistogram(f) {
  const bins = new Float64Array(wasm.memory.buffer, wasm.histogram(), BINS + 2);
  const canvas = el("histogram");
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth || 300, canvas.clientHeight || 90];
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const style = getComputedStyle(document.body);
  const most = Math.log1p(Math.max(...bins.slice(1, -1)));
  const step = width / (BINS + 2);
  bins.forEach((count, bin) => {
    const tall = most ? Math.min(1, Math.log1p(count) / most) * (height - 2) : 0;
    const outside = bin === 0 || bin === BINS + 1;
    context.fillStyle = outside ? style.getPropertyValue("--soft") : bin <= BINS / 2 ? "#3291e6" : "#f0782d";
    context.fillRect(bin * step + 0.5, height - tall, step - 1, tall);
  });
  el("least").textContent = signed(-f.limit);
  el("most").textContent = signed(f.limit);
}

// --- controls ---

function build() {
  const box = el("widths");
  settings.widths.forEach(({ name, low, high, about }, index) => {
    const label = document.createElement("label");
    label.title = about;
    label.innerHTML = `<span>${name}</span><input type="range" min="${low}" max="${high}" step="1" id="width-${name}" aria-label="${name}, bits"><output></output>`;
    const slider = label.querySelector("input");
    slider.addEventListener("input", () => {
      design.widths[index] = Number(slider.value);
      changed();
    });
    box.append(label);
  });
  for (const name of settings.order) {
    const button = document.createElement("button");
    button.textContent = button.dataset.design = name;
    button.addEventListener("click", () => choose(name));
    el("designs").append(button);
  }
  for (const name of ["rounding", "traversal"]) {
    el(name).addEventListener("change", () => { design[name] = Number(el(name).value); changed(); });
  }
  el("hold").addEventListener("change", () => { state.design = true; request(); });
  el("home").addEventListener("click", () => { reset(); request(); });
  for (const name of LAYERS) {
    listen(el(name));
    const button = document.createElement("button");
    button.textContent = button.dataset.layer = name;
    button.addEventListener("click", () => only(name));
    el("layers").append(button);
  }
  only("fixed");
  addEventListener("resize", () => { state.design = true; request(); });
}

// On a narrow screen one picture is shown at a time.
function only(shown) {
  for (const name of LAYERS) el(name).closest("figure").classList.toggle("shown", name === shown);
  for (const button of el("layers").children) button.setAttribute("aria-pressed", button.dataset.layer === shown);
}

function choose(name) {
  design = structuredClone(settings.designs[name]);
  changed();
}

function changed() {
  settings.widths.forEach(({ name }, index) => {
    const slider = el(`width-${name}`);
    slider.value = design.widths[index];
    slider.nextElementSibling.textContent = design.widths[index];
  });
  el("rounding").value = design.rounding;
  el("traversal").value = design.traversal;
  for (const button of el("designs").children) {
    button.setAttribute("aria-pressed", JSON.stringify(settings.designs[button.dataset.design]) === JSON.stringify(design));
  }
  state.design = true;
  request();
}

// --- for tests and measurements: `splatline.bench(10)` in the console ---

window.splatline = {
  settings, figures, checksum, orbit, choose,
  value: (layer, channel, x, y) => wasm.value(layer, channel, x, y),
  set(name, value) {
    const slider = el(`width-${name}`);
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  },
  draw: () => frame(),
  layers: LAYERS,
  // Mean milliseconds of a frame with these layers, and of its parts, over a turn of the camera.
  bench(frames, layers = LAYERS) {
    const whole = layers.length === LAYERS.length;
    const parts = {};
    const work = { fixed: () => wasm.draw(1), ...(whole && { float: () => wasm.draw(2), error: () => wasm.compare(settings.percentile, 0) }),
      canvases: () => show(layers, ...camera.size) };
    const started = performance.now();
    for (let i = 0; i < frames; i += 1) {
      orbit(0.02, 0);
      writeCamera(1);
      for (const [part, does] of Object.entries(work)) {
        const at = performance.now();
        does();
        parts[part] = (parts[part] || 0) + (performance.now() - at) / frames;
      }
    }
    const mean = (performance.now() - started) / frames;
    clearTimeout(state.timer);
    state.moving = false;
    return { whole: mean, ...parts };
  },
};

start().catch((error) => {
  el("failure").textContent = `This page cannot draw: ${error.message}`;
  el("failure").hidden = false;
  console.error(error);
});
