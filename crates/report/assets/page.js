// The frame that is shown, what changes it, and what is told of it.
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
let waiting = false, timer = null;

// What the picture is of, in words.
const spoken = () => state.fit === null ? `frame ${data.frames[state.frame]}` : `frame ${data.frames[state.frame]}, step ${state.step} of its fit`;

function told() {
  const number = data.frames[state.frame], parts = [`Frame ${number} (${(number / data.rate).toFixed(2)} s)`];
  if (state.fit !== null) return `${parts[0]}. ${stepWords(data.fits[state.fit], state.step)}.`;
  const iou = data.iou[state.frame];
  if (iou !== null) parts.push(`IoU ${iou.toFixed(3)}`);
  const all = data.doubts.frames[state.frame] || [];
  for (const [wrong, word] of [[1, "Wrong"], [0, "Doubtful"]]) {
    const limbs = all.filter(doubt => doubt[1] === wrong).map(([limb, , reason]) => `${data.limbs[limb].name} (${data.doubts.reasons[reason]})`);
    if (limbs.length) parts.push(`${word}: ${limbs.join(", ")}`);
  }
  if (data.lost[state.frame]) parts.push(`Lost: ${data.lost[state.frame]}`);
  const marked = data.bookmarks.filter(mark => mark.frame === number).map(mark => mark.text);
  if (marked.length) parts.push(`Bookmark: ${marked.join("; ")}`);
  return `${parts.join(". ")}.`;
}

// Draws again when the screen is next drawn.
function requestShow() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; show(); });
}

function show() {
  by("frame").value = state.frame;
  by("frame").setAttribute("aria-valuetext", `Frame ${data.frames[state.frame]}`);
  if (document.activeElement !== by("number")) by("number").value = data.frames[state.frame];
  const text = told();
  if (by("live").textContent !== text) by("live").textContent = text;
  if (data.cameras.length) { showNearest(); views.forEach(drawView); }
  drawScene();
  showSteps();
  drawPlots();
}

function setFrame(index) {
  Object.assign(state, { frame: Math.min(last, Math.max(0, index)), fit: null });
  requestShow();
}

// Playing is at the take's own speed, or at four frames a second where less motion is asked for. Nobody reads a line that fast.
function play() {
  if (state.frame === last) state.frame = 0;
  state.playing = true;
  by("live").setAttribute("aria-live", "off");
  const rate = calm.matches ? 4 : data.rate, began = performance.now(), first = data.frames[state.frame];
  const go = () => {
    if (!state.playing) return;
    const number = first + Math.floor((performance.now() - began) / 1000 * rate);
    setFrame(number >= data.frames[last] ? last : Math.max(state.frame, nearestIndex(number)));
    if (state.frame === last) stop(); else timer = calm.matches ? setTimeout(go, 250) : requestAnimationFrame(go);
  };
  go();
  showPlaying();
}

function stop() {
  if (!state.playing) return;
  state.playing = false;
  if (calm.matches) clearTimeout(timer); else cancelAnimationFrame(timer);
  by("live").setAttribute("aria-live", "polite");
  showPlaying();
}

function showPlaying() {
  by("play").textContent = state.playing ? "Pause" : "Play";
  by("play").setAttribute("aria-pressed", String(state.playing));
}

const nextDoubt = () => {
  stop();
  const next = doubtful.find(index => index > state.frame);
  setFrame(next === undefined ? doubtful[0] : next);
};

// Under the slider: doubtful frames, lost ones taller, bookmarks as triangles.
function drawMarks() {
  const { context, width, height } = prepared(by("marks")), inset = 8;
  const x = index => inset + (width - 2 * inset) * index / Math.max(1, last);
  context.fillStyle = colour("--warn");
  for (const index of Object.keys(data.doubts.frames)) context.fillRect(x(index) - 1, 0, 2, 4);
  context.fillStyle = colour("--error");
  for (const index of Object.keys(data.lost)) context.fillRect(x(index) - 1, 0, 2, height);
  context.fillStyle = colour("--accent-text");
  for (const mark of data.bookmarks) {
    const at = x(nearestIndex(mark.frame));
    context.beginPath(); context.moveTo(at, 2); context.lineTo(at + 4, height); context.lineTo(at - 4, height); context.fill();
  }
  const count = (number, word) => `${number} ${word}`;
  by("marks").setAttribute("aria-label", `Marks: ${count(Object.keys(data.doubts.frames).length, "doubtful frames")}, ${count(Object.keys(data.lost).length, "lost")}, ${count(data.bookmarks.length, "bookmarks")}`);
}

function setMode(mode) {
  state.mode = mode;
  document.querySelector(`input[name=mode][value=${mode}]`).checked = true;
  requestShow();
}

function setJoint(joint) {
  state.joint = joint;
  by("joint").value = joint;
  requestShow();
}

// Where an address ends in #frame=42 or #bookmark=0, the page is there.
function follow(address) {
  const [, what, value] = /^#(frame|bookmark)=(\d+)$/.exec(address) || [];
  if (!what) return;
  stop();
  const mark = what === "bookmark" ? data.bookmarks[Number(value)] : { frame: Number(value), joint: null, camera: null };
  if (!mark) return;
  views.forEach(view => view.figure.classList.toggle("is-marked", view.index === mark.camera));
  if (mark.joint !== null) setJoint(mark.joint);
  setFrame(nearestIndex(mark.frame));
  window.scrollTo({ top: 0 });
}

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const target = event.target, kind = target.tagName;
  if (kind === "SELECT" || (kind === "INPUT" && target.type !== "range") || target === by("step")) return;
  const isButton = kind === "BUTTON" || kind === "A";
  const moves = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: 10, ArrowDown: -10, Home: -Infinity, End: Infinity };
  const modes = ["overlay", "limbs", "picture"];
  if (event.key in moves) { stop(); setFrame(state.frame + moves[event.key]); }
  else if (event.key === " " && !isButton) { if (state.playing) stop(); else play(); }
  else if (event.key === "n" || event.key === "N") { if (doubtful.length) nextDoubt(); }
  else if ((event.key === "m" || event.key === "M") && data.cameras.length) setMode(modes[(modes.indexOf(state.mode) + 1) % 3]);
  else return;
  event.preventDefault();
}

function wireTheme() {
  const root = document.documentElement, light = window.matchMedia("(prefers-color-scheme: light)");
  const isLight = () => root.dataset.theme ? root.dataset.theme === "light" : light.matches;
  const told = () => { by("theme").textContent = isLight() ? "Dark theme" : "Light theme"; drawMarks(); show(); };
  by("theme").onclick = () => { root.dataset.theme = isLight() ? "dark" : "light"; told(); };
  light.addEventListener("change", told);
  told();
}

function begin() {
  by("frame").max = last;
  by("frame").oninput = () => { stop(); setFrame(Number(by("frame").value)); };
  Object.assign(by("number"), { min: data.frames[0], max: data.frames[last] });
  by("number").onchange = () => { stop(); setFrame(nearestIndex(Number(by("number").value))); };
  by("play").onclick = () => { if (state.playing) stop(); else play(); };
  by("doubt").onclick = nextDoubt;
  by("doubt").disabled = doubtful.length === 0;
  document.querySelectorAll("input[name=mode]").forEach(input => { input.onchange = () => setMode(input.value); });
  by("joint").append(element("option", { value: -1 }, "none"), ...jointNames.map((name, index) => element("option", { value: index }, name)));
  by("joint").onchange = () => setJoint(Number(by("joint").value));
  wireScene();
  wireSteps();
  wirePlots();
  window.addEventListener("keydown", pressed);
  window.addEventListener("hashchange", () => follow(location.hash));
  // A link to where the address already is changes nothing there.
  document.addEventListener("click", event => {
    const link = event.target.closest("a[href^='#']");
    if (link) follow(link.getAttribute("href"));
  });
  new ResizeObserver(() => { drawMarks(); requestShow(); }).observe(document.body);
  wireTheme();
  follow(location.hash);
}

if (data.frames.length) begin();
