// Numbers over frames. A plot's curves are drawn once a size; the cursor lies over them.
const inks = ["#4182DE", "#D06911", "#117865", "#BF7FA5", "#C43037", "#6D5CA1"];
const dashes = [[], [7, 3], [2, 3.5], [10, 3, 2, 3], [4, 4], [1, 3]];
const MARGIN = { left: 52, right: 10, top: 8, bottom: 20 };

const plots = [...new Set(data.curves.map(curve => curve.group))].map(group => {
  const curves = data.curves.filter(curve => curve.group === group).map((curve, index) => ({ ...curve, index: index % 6 }));
  const canvas = element("canvas", { role: "img" }), list = element("ul");
  for (const curve of curves) {
    const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg"), stroke = document.createElementNS(swatch.namespaceURI, "line");
    for (const [key, value] of Object.entries({ width: 22, height: 6, "aria-hidden": "true" })) swatch.setAttribute(key, value);
    for (const [key, value] of Object.entries({ x1: 0, y1: 3, x2: 22, y2: 3, stroke: inks[curve.index], "stroke-width": 2, "stroke-dasharray": dashes[curve.index].join(" ") })) stroke.setAttribute(key, value);
    swatch.append(stroke);
    curve.value = element("span");
    list.append(element("li", {}, swatch, element("span", {}, curve.label), curve.value));
  }
  const unit = curves[0].unit ? `, ${curves[0].unit}` : "";
  by("plots").append(element("div", { class: "plot" }, element("h3", {}, group + unit), canvas, list));
  const known = curves.flatMap(curve => curve.values.filter(value => value !== null));
  let [low, high] = known.length ? known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]) : [0, 1];
  if (high - low < 1e-9) [low, high] = [low - 0.5, high + 0.5];
  const room = 0.06 * (high - low);
  return { group, curves, canvas, drawn: null, range: [low >= 0 && low < room ? 0 : low - room, high + room] };
});
if (plots.length === 0) by("curves").hidden = true;

// Round numbers between two; `about` is how many are wanted.
function ticks([low, high], about) {
  const rough = (high - low) / about, size = 10 ** Math.floor(Math.log10(rough)), step = [1, 2, 5, 10].map(times => times * size).find(step => step >= rough);
  const found = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9 * step; value += step) found.push(Math.abs(value) < step * 1e-6 ? 0 : value);
  return { values: found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}
const tickText = (value, digits) => Math.abs(value) >= 1e5 ? value.toExponential(1).replace("e+", "e") : value.toFixed(digits);

// From a frame's place in the list to points, by the frames' numbers.
function across(width) {
  const [first, end] = [data.frames[0], data.frames[last]], span = Math.max(1, end - first);
  return {
    x: index => MARGIN.left + (width - MARGIN.left - MARGIN.right) * (data.frames[index] - first) / span,
    frame: x => first + span * (x - MARGIN.left) / (width - MARGIN.left - MARGIN.right),
  };
}

function drawGround(plot, width, height, density) {
  const ground = document.createElement("canvas");
  [ground.width, ground.height] = [plot.canvas.width, plot.canvas.height];
  const context = ground.getContext("2d"), { x } = across(width), [low, high] = plot.range;
  context.setTransform(density, 0, 0, density, 0, 0);
  const y = value => MARGIN.top + (height - MARGIN.top - MARGIN.bottom) * (high - value) / (high - low);
  context.font = "11px ui-monospace, monospace";
  context.fillStyle = colour("--text2");
  context.strokeStyle = colour("--grid");
  context.lineWidth = 1;
  context.textAlign = "right";
  context.textBaseline = "middle";
  const heights = ticks(plot.range, 4);
  for (const value of heights.values) {
    context.beginPath(); context.moveTo(MARGIN.left, y(value)); context.lineTo(width - MARGIN.right, y(value)); context.stroke();
    context.fillText(tickText(value, heights.digits), MARGIN.left - 6, y(value));
  }
  context.textAlign = "center";
  context.textBaseline = "bottom";
  const [first, end] = [data.frames[0], data.frames[last]], span = Math.max(1, end - first);
  for (const value of ticks([first, end + 1e-9], Math.max(2, width / 110)).values) {
    if (value % 1 !== 0) continue;
    context.fillText(String(value), MARGIN.left + (width - MARGIN.left - MARGIN.right) * (value - first) / span, height - 4);
  }
  for (const index of Object.keys(data.lost)) {
    context.fillStyle = "rgba(196, 48, 55, 0.25)";
    context.fillRect(x(index) - 1, MARGIN.top, 2, height - MARGIN.top - MARGIN.bottom);
  }
  for (const curve of plot.curves) stroke(context, curve, x, y);
  return ground;
}

// One curve; where there are more values than points, the least and the greatest of every column.
function stroke(context, curve, x, y) {
  context.strokeStyle = inks[curve.index];
  context.lineWidth = 1.75;
  context.setLineDash(dashes[curve.index]);
  context.beginPath();
  let pen = false, column = null;
  const flush = () => {
    if (!column) return;
    const [place, low, high] = column;
    if (pen) context.lineTo(place, y(low)); else context.moveTo(place, y(low));
    context.lineTo(place, y(high));
    pen = true;
    column = null;
  };
  for (let index = 0; index <= last; index++) {
    const value = curve.values[index], gap = index > 0 && data.frames[index] - data.frames[index - 1] > 1 && data.frames[index] - data.frames[index - 1] > 2 * usualStep;
    if (value === null || gap) { flush(); pen = false; }
    if (value === null) continue;
    const place = Math.round(2 * x(index)) / 2;
    if (column && column[0] === place) { column[1] = Math.min(column[1], value); column[2] = Math.max(column[2], value); continue; }
    flush();
    column = [place, value, value];
  }
  flush();
  context.stroke();
  context.setLineDash([]);
}
// How far frames are apart as a rule: a track of every fifth frame has no gaps.
const usualStep = (() => {
  const steps = data.frames.slice(1, 200).map((number, index) => number - data.frames[index]).sort((a, b) => a - b);
  return steps[Math.floor(steps.length / 2)] || 1;
})();

function drawPlots() {
  for (const plot of plots) {
    const { context, width, height, density } = prepared(plot.canvas), key = `${width} ${height} ${density} ${colour("--plot")}`;
    if (plot.key !== key) [plot.key, plot.ground] = [key, drawGround(plot, width, height, density)];
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(plot.ground, 0, 0);
    context.restore();
    const x = across(width).x(state.frame);
    context.strokeStyle = colour("--accent-text");
    context.lineWidth = 1.5;
    context.beginPath(); context.moveTo(x, MARGIN.top); context.lineTo(x, height - MARGIN.bottom); context.stroke();
    const said = plot.curves.map(curve => { curve.value.textContent = short(curve.values[state.frame]); return `${curve.label} ${curve.value.textContent}`; });
    plot.canvas.setAttribute("aria-label", `${plot.group} over frames. Frame ${data.frames[state.frame]}: ${said.join(", ")}`);
  }
}

// The place in the list of the frame nearest to a number.
function nearestIndex(number) {
  let [low, high] = [0, last];
  while (low < high) { const middle = (low + high) >> 1; if (data.frames[middle] < number) low = middle + 1; else high = middle; }
  return low > 0 && number - data.frames[low - 1] < data.frames[low] - number ? low - 1 : low;
}

function wirePlots() {
  for (const { canvas } of plots) {
    const go = event => setFrame(nearestIndex(across(canvas.clientWidth).frame(event.clientX - canvas.getBoundingClientRect().left)));
    canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); go(event); });
    canvas.addEventListener("pointermove", event => { if (event.buttons & 1) go(event); });
  }
}
