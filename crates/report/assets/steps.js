// The steps of a fit: a second slider, and the cost by step.
function wireSteps() {
  if (data.fits.length === 0) { by("fits").hidden = true; return; }
  data.fits.forEach((fit, index) => by("fit").append(element("option", { value: index }, `frame ${data.frames[fit.frame]}`)));
  by("fit").onchange = () => showStep(Number(by("fit").value), data.fits[Number(by("fit").value)].steps.length - 1);
  by("step").oninput = () => showStep(Number(by("fit").value), Number(by("step").value));
  by("step").max = data.fits[0].steps.length - 1;
  by("step").value = by("step").max;
  by("back").onclick = () => setFrame(state.frame);
  const canvas = by("costs"), go = event => {
    const fit = Number(by("fit").value), count = data.fits[fit].steps.length - 1, width = canvas.clientWidth;
    const place = (event.clientX - canvas.getBoundingClientRect().left - MARGIN.left) / (width - MARGIN.left - MARGIN.right);
    showStep(fit, Math.min(count, Math.max(0, Math.round(place * count))));
  };
  canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); go(event); });
  canvas.addEventListener("pointermove", event => { if (event.buttons & 1) go(event); });
}

function showStep(fit, step) {
  stop();
  Object.assign(state, { frame: data.fits[fit].frame, fit, step });
  by("fit").value = fit;
  by("step").max = data.fits[fit].steps.length - 1;
  by("step").value = step;
  show();
}

function stepWords(fit, step) {
  const [cost, trial, stage, accepted] = fit.steps[step], of = fit.steps.length - 1;
  const how = step === 0 ? "the start" : accepted ? "accepted" : `rejected: it would cost ${short(trial)}`;
  return `Step ${step} of ${of}, stage ${stage + 1}, ${how}. Cost ${short(cost)}`;
}

function showSteps() {
  if (data.fits.length === 0) return;
  const index = state.fit === null ? Number(by("fit").value) : state.fit, fit = data.fits[index];
  const step = Number(by("step").value);
  by("back").disabled = state.fit === null;
  by("step").setAttribute("aria-valuetext", stepWords(fit, step));
  by("told").textContent = state.fit === null
    ? `The fit of frame ${data.frames[fit.frame]}, run again from ${fit.start}: ${fit.steps.length - 1} steps, then ${fit.ending}. The slider shows them in all views.`
    : stepWords(fit, step) + ".";
  drawCosts(fit, state.fit === null ? null : step);
}

function drawCosts(fit, shown) {
  const canvas = by("costs"), { context, width, height } = prepared(canvas), count = Math.max(1, fit.steps.length - 1);
  const logs = fit.steps.map(([cost]) => Math.log10(Math.max(cost || 1e-9, 1e-9)));
  let [low, high] = [Math.min(...logs), Math.max(...logs)];
  if (high - low < 0.02) [low, high] = [low - 0.01, high + 0.01];
  const x = step => MARGIN.left + (width - MARGIN.left - MARGIN.right) * step / count;
  const y = log => 10 + (height - 34) * (high - log) / (high - low);
  context.font = "11px ui-monospace, monospace";
  context.fillStyle = colour("--text2");
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const log of [low, high]) context.fillText((10 ** log).toExponential(1).replace("e+", "e"), MARGIN.left - 6, y(log));
  context.textBaseline = "bottom";
  context.textAlign = "center";
  context.fillText("0", x(0), height - 3);
  context.fillText(String(count), x(count), height - 3);
  // Each stage has its own measure: its costs are a curve of their own.
  context.strokeStyle = inks[0];
  context.lineWidth = 1.75;
  context.beginPath();
  let stage = null;
  fit.steps.forEach(([, , of, accepted], step) => {
    if (!accepted) return;
    if (of !== stage) context.moveTo(x(step), y(logs[step])); else context.lineTo(x(step), y(logs[step]));
    stage = of;
  });
  context.stroke();
  fit.steps.forEach(([, , , accepted], step) => {
    const [px, py] = [x(step), y(logs[step])];
    context.beginPath();
    if (accepted) { context.fillStyle = inks[0]; context.arc(px, py, 2.3, 0, 2 * Math.PI); context.fill(); return; }
    context.strokeStyle = colour("--error");
    context.lineWidth = 1.5;
    context.moveTo(px - 3, py - 12); context.lineTo(px + 3, py - 6); context.moveTo(px - 3, py - 6); context.lineTo(px + 3, py - 12);
    context.stroke();
  });
  if (shown !== null) {
    context.strokeStyle = colour("--accent-text");
    context.lineWidth = 1.5;
    context.beginPath(); context.moveTo(x(shown), 2); context.lineTo(x(shown), height - 20); context.stroke();
  }
  canvas.setAttribute("aria-label", `Cost by step of the fit of frame ${data.frames[fit.frame]}, from ${short(fit.steps[0][0])} to ${short(fit.steps[fit.steps.length - 1][0])}${shown === null ? "" : `. ${stepWords(fit, shown)}`}`);
}
