// The body, the floor and the cameras in space, turned by hand.
const orbit = {};
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b, times) => a.map((value, i) => value + times * b[i]);
const unit = a => { const length = Math.hypot(...a) || 1; return a.map(value => value / length); };

// Up and two directions on the floor.
const up = unit(data.up), east = unit(cross(Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], up)), north = cross(up, east);
// The middle of the track, the floor's height and how far the track goes from the middle, from some frames.
const room = (() => {
  const lows = [], sum = [0, 0, 0], every = Math.max(1, Math.floor(data.frames.length / 200));
  let count = 0, reach = 1;
  for (let frame = 0; frame <= last; frame += every) {
    let low = Infinity;
    for (let joint = 0; joint < jointCount; joint++) {
      const place = track.subarray(3 * (frame * jointCount + joint)), radius = joint ? data.limbs[joint - 1].radius : 0;
      low = Math.min(low, dot(up, place) - radius);
    }
    lows.push(low);
    for (let i = 0; i < 3; i++) sum[i] += track[3 * frame * jointCount + i];
    count++;
  }
  const middle = sum.map(value => value / Math.max(count, 1));
  for (let frame = 0; frame <= last; frame += every) {
    const away = plus([...track.subarray(3 * frame * jointCount, 3 * frame * jointCount + 3)], middle, -1);
    reach = Math.max(reach, 0.8 + Math.hypot(...away));
  }
  lows.sort((a, b) => a - b);
  return { middle, floor: lows[Math.floor(lows.length / 10)] || 0, reach: Math.min(reach, 4) };
})();

// Where the cameras are, and a view that has most of the way to them in it.
const centres = data.cameras.map(({ r, t }) => [0, 1, 2].map(axis => -(r[axis] * t[0] + r[3 + axis] * t[1] + r[6 + axis] * t[2])));
const farthest = Math.max(0, ...centres.map(centre => Math.hypot(...plus(centre, room.middle, -1))));
const usualView = () => Object.assign(orbit, { azimuth: 0.7, elevation: 0.35, zoom: farthest ? Math.min(1, Math.max(0.35, 1.7 * room.reach / farthest)) : 1 });
usualView();

// The orbit view: takes points to its axes, x right, y down, z ahead.
function viewpoint() {
  const flat = plus(east.map(value => value * Math.cos(orbit.azimuth)), north, Math.sin(orbit.azimuth));
  const back = plus(flat.map(value => value * Math.cos(orbit.elevation)), up, Math.sin(orbit.elevation));
  const distance = 3.2 * room.reach / orbit.zoom, eye = plus(room.middle, back, distance);
  const ahead = back.map(value => -value), right = unit(cross(ahead, up)), down = cross(ahead, right);
  return (x, y, z) => {
    const from = [x - eye[0], y - eye[1], z - eye[2]];
    return [dot(right, from), dot(down, from), dot(ahead, from)];
  };
}

function drawScene() {
  const canvas = by("scene"), { context, width, height } = prepared(canvas);
  const see = viewpoint(), focal = 1.3 * height, centre = [width / 2, height / 2];
  const flat = ([x, y, z]) => [centre[0] + focal * x / z, centre[1] + focal * y / z];
  // A line from one point to another, cut where it comes too near.
  const line = (from, to) => {
    let [a, b] = [see(...from), see(...to)];
    if (a[2] < NEAR && b[2] < NEAR) return;
    const cut = (p, q) => p[2] >= NEAR ? p : p.map((value, i) => value + (q[i] - value) * (NEAR - p[2]) / (q[2] - p[2]));
    [a, b] = [cut(a, b), cut(b, a)];
    context.moveTo(...flat(a));
    context.lineTo(...flat(b));
  };
  context.fillStyle = "#17191C";
  context.fillRect(0, 0, width, height);
  drawFloor(context, line);
  data.cameras.forEach((camera, index) => drawFrustum(context, camera, index, line, see, flat));
  drawBody(context, capsules(see, [focal, focal], centre));
  if (state.joint >= 0) {
    const place = see(...pose().subarray(3 * state.joint, 3 * state.joint + 3));
    if (place[2] > NEAR) markJoint(context, flat(place), 5);
  }
  const degrees = angle => `${Math.round(angle * 180 / Math.PI)}°`;
  canvas.setAttribute("aria-label", `Scene, ${spoken()}: the body${data.cameras.length ? ` and ${data.cameras.length} cameras` : ""}, seen from ${degrees(orbit.azimuth)} around and ${degrees(orbit.elevation)} above. Arrow keys turn it, + and − come closer and go farther.`);
}

// A grid of half metres around the middle.
function drawFloor(context, line) {
  const middle = plus(room.middle, up, room.floor - dot(up, room.middle)), half = Math.ceil(2 * room.reach) / 2 + 1;
  const snapped = [east, north].map(axis => Math.round(2 * dot(axis, middle)) / 2);
  const corner = (a, b) => plus(plus(up.map(value => value * room.floor), east, snapped[0] + a), north, snapped[1] + b);
  context.beginPath();
  for (let at = -half; at <= half + 1e-9; at += 0.5) {
    line(corner(at, -half), corner(at, half));
    line(corner(-half, at), corner(half, at));
  }
  context.strokeStyle = "#343A41";
  context.lineWidth = 1;
  context.stroke();
}

function drawFrustum(context, camera, index, line, see, flat) {
  const [fx, fy, cx, cy] = camera.k, depth = 0.25 * room.reach;
  // From camera axes to the world.
  const world = place => [0, 1, 2].map(axis => [0, 1, 2].reduce((sum, row) => sum + camera.r[3 * row + axis] * (place[row] - camera.t[row]), 0));
  const centre = world([0, 0, 0]), [w, h] = camera.size;
  const corners = [[0, 0], [w, 0], [w, h], [0, h]].map(([x, y]) => world([(x - 0.5 - cx) / fx * depth, (y - 0.5 - cy) / fy * depth, depth]));
  context.beginPath();
  corners.forEach((corner, i) => { line(centre, corner); line(corner, corners[(i + 1) % 4]); });
  context.strokeStyle = cameraColours[index % 8];
  context.lineWidth = 1.5;
  context.stroke();
  const at = see(...centre);
  if (at[2] < NEAR) return;
  const [x, y] = flat(at);
  context.fillStyle = cameraColours[index % 8];
  context.fillRect(x - 8, y - 8, 16, 16);
  context.fillStyle = onCamera[index % 8];
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(String(index + 1), x, y + 0.5);
}

// Shaded across each limb, the nearest last.
function drawBody(context, all) {
  const marked = doubts();
  for (const capsule of all) {
    const { a, b } = capsule, path = outlineOf(capsule), [dx, dy] = unit([b[0] - a[0], b[1] - a[1], 0]);
    let across = [-dy, dx];
    // The light comes from the upper left.
    if (across[0] + across[1] > 0) across = [dy, -dx];
    const r = Math.max(a[2], b[2]), middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    const shade = context.createLinearGradient(middle[0] + across[0] * r, middle[1] + across[1] * r, middle[0] - across[0] * r, middle[1] - across[1] * r);
    [[0, "#B9C2CC"], [0.35, "#98A3AF"], [1, "#4B5560"]].forEach(([place, colour]) => shade.addColorStop(place, colour));
    context.fillStyle = shade;
    context.fill(path);
    context.strokeStyle = "rgba(11, 13, 15, 0.55)";
    context.lineWidth = 1;
    context.stroke(path);
  }
  for (const capsule of all) if (marked.has(capsule.limb)) markDoubt(context, capsule, marked.get(capsule.limb), 2);
}

function turn(azimuth, elevation, zoom) {
  orbit.azimuth = (orbit.azimuth + azimuth) % (2 * Math.PI);
  orbit.elevation = Math.min(1.5, Math.max(-0.4, orbit.elevation + elevation));
  orbit.zoom = Math.min(6, Math.max(0.3, orbit.zoom * zoom));
  drawScene();
}

function wireScene() {
  const canvas = by("scene");
  let from = null;
  canvas.addEventListener("pointerdown", event => { from = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", event => {
    if (!from) return;
    turn(-(event.clientX - from[0]) * 0.008, (event.clientY - from[1]) * 0.008, 1);
    from = [event.clientX, event.clientY];
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { from = null; });
  // The page scrolls over the scene unless the scene has the focus.
  canvas.addEventListener("wheel", event => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    turn(0, 0, Math.exp(-event.deltaY * 0.001));
  }, { passive: false });
  canvas.addEventListener("keydown", event => {
    const step = 0.12, turns = { ArrowLeft: [-step, 0, 1], ArrowRight: [step, 0, 1], ArrowUp: [0, step, 1], ArrowDown: [0, -step, 1], "+": [0, 0, 1.15], "=": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] };
    if (!turns[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    turn(...turns[event.key]);
    event.preventDefault();
    event.stopPropagation();
  });
  by("closer").onclick = () => turn(0, 0, 1.25);
  by("farther").onclick = () => turn(0, 0, 0.8);
  by("reset").onclick = () => { usualView(); drawScene(); };
}
