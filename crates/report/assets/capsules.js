// Limbs as capsules in a pinhole's picture.
const NEAR = 0.05;

// The shown limbs before a camera: two circles each, the nearest last. `see` takes a point to camera axes, `focal` are two lengths
// and `centre` a point of the picture; all in its units.
function capsules(see, focal, centre) {
  const places = pose(), found = [];
  const at = joint => see(places[3 * joint], places[3 * joint + 1], places[3 * joint + 2]);
  const seen = Array.from({ length: jointCount }, (_, joint) => at(joint));
  data.limbs.forEach((limb, index) => {
    let [a, b] = [seen[limb.from], seen[index + 1]];
    if (!(a[2] > NEAR || b[2] > NEAR)) return;
    const cut = (p, q) => p[2] > NEAR ? p : p.map((value, i) => value + (q[i] - value) * (NEAR - p[2]) / (q[2] - p[2]));
    [a, b] = [cut(a, b), cut(b, a)];
    const circle = p => [centre[0] + focal[0] * p[0] / p[2], centre[1] + focal[1] * p[1] / p[2], focal[0] * limb.radius / p[2]];
    found.push({ limb: index, a: circle(a), b: circle(b), depth: a[2] + b[2] });
  });
  return found.sort((one, other) => other.depth - one.depth);
}

// The hull of two circles, clockwise on the screen.
function trace(path, { a, b }) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]], distance = Math.hypot(dx, dy);
  if (distance <= Math.abs(a[2] - b[2]) + 1e-6) {
    const [x, y, r] = a[2] > b[2] ? a : b;
    path.moveTo(x + r, y);
    path.arc(x, y, r, 0, 2 * Math.PI);
    return;
  }
  const along = Math.atan2(dy, dx), tilt = Math.acos((a[2] - b[2]) / distance);
  path.moveTo(a[0] + a[2] * Math.cos(along + tilt), a[1] + a[2] * Math.sin(along + tilt));
  path.arc(a[0], a[1], a[2], along + tilt, along - tilt + 2 * Math.PI);
  path.arc(b[0], b[1], b[2], along - tilt, along + tilt);
  path.closePath();
}

function outlineOf(capsule) {
  const path = new Path2D();
  trace(path, capsule);
  return path;
}

// All limbs as one path: filled by the nonzero rule it is the body's silhouette.
function bodyOf(all) {
  const path = new Path2D();
  all.forEach(capsule => trace(path, capsule));
  return path;
}

// A limb that is not believed: dashed where it is doubtful; red and crossed where it is wrong.
function markDoubt(context, capsule, isWrong, wide) {
  const path = outlineOf(capsule);
  context.save();
  context.lineWidth = wide;
  context.strokeStyle = isWrong ? "#FF6B5E" : "#F0A564";
  if (!isWrong) context.setLineDash([4 * wide, 3 * wide]);
  context.stroke(path);
  if (isWrong) {
    const { a, b } = capsule, [x, y] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], r = Math.max(3 * wide, (a[2] + b[2]) / 2);
    context.beginPath();
    context.moveTo(x - r, y - r); context.lineTo(x + r, y + r);
    context.moveTo(x - r, y + r); context.lineTo(x + r, y - r);
    context.stroke();
  }
  context.restore();
}

// A joint: a yellow disc with a dark edge.
function markJoint(context, [x, y], size) {
  context.beginPath();
  context.arc(x, y, size, 0, 2 * Math.PI);
  context.fillStyle = "#FFD24A";
  context.strokeStyle = "#0B0D0F";
  context.lineWidth = size / 2.5;
  context.fill();
  context.stroke();
}
