// What the page knows, and what is shown of it.
const by = id => document.getElementById(id);
const data = JSON.parse(by("data").textContent);
const jointCount = data.limbs.length + 1;

// Places as three floats a joint, metres.
function unpack(packed) {
  const text = atob(packed.data), count = text.length / 2, out = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    const steps = text.charCodeAt(2 * i) | (text.charCodeAt(2 * i + 1) << 8);
    out[i] = packed.low[i % 3] + packed.step * steps;
  }
  return out;
}

const track = unpack(data.joints);
for (const fit of data.fits) fit.places = unpack(fit.joints);
const indexOf = new Map(data.frames.map((number, index) => [number, index]));
const last = data.frames.length - 1;

// Pictures by frame, then camera; the frames that have one in their order.
const pictures = new Map();
for (const picture of data.pictures) {
  if (!pictures.has(picture.frame)) pictures.set(picture.frame, []);
  pictures.get(picture.frame)[picture.camera] = picture;
}
const pictured = [...pictures.keys()].sort((a, b) => a - b);
const doubtful = [...new Set([...Object.keys(data.doubts.frames), ...Object.keys(data.lost)].map(Number))].sort((a, b) => a - b);

// The frame is a place in the list; a fit's step is shown in its place where there is one.
const state = { frame: 0, fit: null, step: 0, mode: "overlay", joint: -1, playing: false };

// The joints that are shown: three floats a joint.
function pose() {
  const [places, index] = state.fit === null ? [track, state.frame] : [data.fits[state.fit].places, state.step];
  return places.subarray(index * jointCount * 3, (index + 1) * jointCount * 3);
}

// Of each limb that is not believed in the shown pose whether it is wrong. A fit's steps are not judged.
function doubts() {
  const found = new Map();
  if (state.fit === null) for (const [limb, wrong] of data.doubts.frames[state.frame] || []) found.set(limb, wrong === 1);
  return found;
}

const jointNames = ["root", ...data.limbs.map(limb => limb.joint)];
const fixed = (value, digits) => value === null || value === undefined ? "–" : value.toFixed(digits);
// Three digits that count, or as many as stand before the point.
function short(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  if (size >= 1e5) return value.toExponential(2).replace("e+", "e");
  return size >= 100 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : size >= 1 ? value.toFixed(2) : value.toFixed(3);
}
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const cameraColours = ["#488BD3", "#C9742B", "#25754E", "#CD376C", "#6C5DDC", "#AC4A13", "#EE6588", "#9846A3"];
const onCamera = ["#0B0D0F", "#0B0D0F", "#FFFFFF", "#FFFFFF", "#FFFFFF", "#FFFFFF", "#0B0D0F", "#FFFFFF"];

// Fits a canvas to its place on the screen; its size in points, with a context that counts in them.
function prepared(canvas) {
  const width = Math.max(1, canvas.clientWidth), height = Math.max(1, canvas.clientHeight);
  const density = window.devicePixelRatio || 1;
  const [w, h] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.setTransform(density, 0, 0, density, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height, density };
}

function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
  made.append(...children);
  return made;
}
