// What each camera sees.
const views = data.cameras.map((camera, index) => {
  const badge = element("i", { class: "badge", "aria-hidden": "true", style: `background:${cameraColours[index % 8]};color:${onCamera[index % 8]}` }, String(index + 1));
  const value = element("span"), canvas = element("canvas", { role: "img", style: `aspect-ratio:${camera.size[0]}/${camera.size[1]}` });
  const figure = element("figure", {}, element("figcaption", {}, badge, element("b", { title: camera.name }, camera.name), value), canvas);
  by("views").append(figure);
  const curve = data.curves.find(curve => curve.camera === index && curve.unit === "");
  return { camera, index, figure, canvas, value, curve, scratch: document.createElement("canvas"), image: null };
});
if (data.cameras.length === 0) by("cameras").hidden = true;
else {
  const wide = data.cameras.some(camera => camera.size[0] > camera.size[1]);
  by("views").style.setProperty("--least", wide ? "300px" : "150px");
  // Upright pictures leave room below them.
  if (!wide) { by("cameras").append(by("fits")); by("scene").style.aspectRatio = "1"; }
}

const seenBy = camera => (x, y, z) => [0, 3, 6].map((row, axis) =>
  camera.r[row] * x + camera.r[row + 1] * y + camera.r[row + 2] * z + camera.t[axis]);

// The decoded picture; what is shown is drawn again when it is there.
function imageOf(view, picture) {
  if (!picture || !picture.source) return null;
  if (!picture.image) {
    picture.image = new Image();
    picture.image.onload = () => requestShow();
    picture.image.src = picture.source;
  }
  return picture.image.complete && picture.image.naturalWidth ? picture.image : null;
}

function drawView(view) {
  const { camera, canvas } = view, { context, width, height, density } = prepared(canvas), scale = width / camera.size[0];
  const [fx, fy, cx, cy] = camera.k;
  const all = capsules(seenBy(camera), [fx * scale, fy * scale], [(cx + 0.5) * scale, (cy + 0.5) * scale]);
  const picture = (pictures.get(state.frame) || [])[view.index], image = imageOf(view, picture);
  context.fillStyle = "#17191C";
  context.fillRect(0, 0, width, height);
  if (image) {
    context.drawImage(image, 0, 0, width, height);
    if (state.mode !== "picture") {
      context.fillStyle = "rgba(0, 0, 0, 0.18)";
      context.fillRect(0, 0, width, height);
    }
  }
  if (state.mode === "overlay" && picture && picture.subject) tint(view, context, all, picture, scale, density);
  else if (state.mode !== "picture" || !picture) drawLimbs(context, all, Boolean(image));
  if (state.mode !== "picture") {
    const marked = doubts();
    for (const capsule of all) if (marked.has(capsule.limb)) markDoubt(context, capsule, marked.get(capsule.limb), 1.5);
    if (state.joint >= 0) {
      const places = pose(), [x, y, z] = seenBy(camera)(...places.subarray(3 * state.joint, 3 * state.joint + 3));
      if (z > NEAR) markJoint(context, [(cx + 0.5 + fx * x / z) * scale, (cy + 0.5 + fy * y / z) * scale], 5);
    }
  }
  const iou = state.fit === null && view.curve ? view.curve.values[state.frame] : null;
  view.value.textContent = iou === null || iou === undefined ? "" : `IoU ${iou.toFixed(3)}`;
  const what = image ? { overlay: "picture with subject and body compared", limbs: "picture with the body's limbs", picture: "picture alone" }[state.mode] : "the body's limbs on a plain ground";
  canvas.setAttribute("aria-label", `Camera ${camera.name}, ${spoken()}: ${what}${iou ? `, IoU ${iou.toFixed(3)}` : ""}`);
}

function drawLimbs(context, all, isOver) {
  for (const capsule of all) {
    const path = outlineOf(capsule);
    if (!isOver) { context.fillStyle = "#4A525B"; context.fill(path); }
    context.strokeStyle = "rgba(11, 13, 15, 0.55)";
    context.lineWidth = 2.5;
    context.stroke(path);
    context.strokeStyle = "#EAF0F5";
    context.lineWidth = 1;
    context.stroke(path);
  }
}

// Agreement, subject without body, body without subject; what is unknown is hatched and left out.
function tint(view, context, all, picture, scale, density) {
  const scratch = view.scratch, { width, height } = view.canvas;
  if (scratch.width !== width || scratch.height !== height) [scratch.width, scratch.height] = [width, height];
  const layer = scratch.getContext("2d"), body = bodyOf(all);
  picture.paths = picture.paths || [new Path2D(picture.subject), new Path2D(picture.unknown)];
  const [subject, unknown] = picture.paths, own = () => layer.setTransform(density, 0, 0, density, 0, 0);
  const theirs = () => layer.setTransform(density * scale, 0, 0, density * scale, 0, 0);
  const put = (alpha, fill) => {
    layer.setTransform(1, 0, 0, 1, 0, 0);
    layer.globalCompositeOperation = "source-over";
    layer.clearRect(0, 0, width, height);
    fill();
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.globalAlpha = alpha;
    context.drawImage(scratch, 0, 0);
    context.restore();
  };
  const both = (operation, alpha, fill) => put(alpha, () => {
    theirs(); layer.fillStyle = fill; layer.fill(subject);
    layer.globalCompositeOperation = operation; own(); layer.fill(body);
  });
  both("source-in", 0.34, "#84919E");
  both("destination-out", 0.62, "#DC6A12");
  put(0.62, () => {
    own(); layer.fillStyle = "#2F80DB"; layer.fill(body);
    layer.globalCompositeOperation = "destination-out"; theirs(); layer.fill(subject); layer.fill(unknown);
  });
  context.save();
  context.scale(scale, scale);
  context.clip(unknown);
  context.strokeStyle = "rgba(132, 145, 158, 0.8)";
  context.lineWidth = 1 / scale;
  context.beginPath();
  const [across, down] = view.camera.size, apart = 5 / scale;
  for (let at = -down; at < across; at += apart) { context.moveTo(at, 0); context.lineTo(at + down, down); }
  context.stroke();
  context.restore();
  outlineBody(layer, context, all, density, width, height);
}

// The outline of the limbs' union: what is left of a wide stroke around them once they are cut out.
function outlineBody(layer, context, all, density, width, height) {
  layer.setTransform(1, 0, 0, 1, 0, 0);
  layer.globalCompositeOperation = "source-over";
  layer.clearRect(0, 0, width, height);
  layer.setTransform(density, 0, 0, density, 0, 0);
  layer.strokeStyle = "#EAF0F5";
  layer.lineWidth = 2.5;
  layer.lineJoin = "round";
  const body = bodyOf(all);
  layer.stroke(body);
  layer.globalCompositeOperation = "destination-out";
  layer.fill(body);
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.drawImage(layer.canvas, 0, 0);
  context.restore();
}

// Which frame with a picture is nearest, where this one has none.
function showNearest() {
  const line = by("nearest"), [text, button] = [line.querySelector("span"), line.querySelector("button")];
  if (pictured.length === 0) { line.hidden = true; return; }
  const isHere = pictures.has(state.frame), share = `${pictured.length} of ${data.frames.length} frames have pictures in this page`;
  line.classList.toggle("is-here", isHere);
  const nearest = pictured.reduce((best, frame) => Math.abs(frame - state.frame) < Math.abs(best - state.frame) ? frame : best);
  text.textContent = isHere ? `${share}; this one has.` : `No picture in the page for this frame; nearest: ${data.frames[nearest]}`;
  button.hidden = isHere;
  button.setAttribute("aria-label", `Go to frame ${data.frames[nearest]}, which has pictures`);
  button.onclick = () => setFrame(nearest);
}
