// Drives the page as a reader would. Arguments: node_modules, Chromium, the folder with the pages, and where pictures are kept.
import { createRequire } from "node:module";
import assert from "node:assert/strict";

const [modules, executablePath, folder, shots] = process.argv.slice(2);
const { chromium } = createRequire(`${modules}/`)("playwright-core");
const args = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const context = await chromium.launchPersistentContext(`${folder}/profile`, { executablePath, args, headless: true, viewport: { width: 1280, height: 900 }, colorScheme: "dark" });
const errors = [], requests = [];

async function open(name) {
  const page = await context.newPage();
  page.on("console", message => { if (["error", "warning"].includes(message.type())) errors.push(message.text()); });
  page.on("pageerror", error => errors.push(String(error)));
  page.on("dialog", dialog => { errors.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  page.on("request", request => { if (!/^(file|data):/.test(request.url())) requests.push(request.url()); });
  await page.goto(`file://${folder}/${name}`);
  await page.waitForFunction(() => document.getElementById("live").textContent !== "");
  return page;
}
const page = await open("page.html");
// The line that is read out, once the page has drawn.
const live = () => page.evaluate(async () => {
  await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
  return document.getElementById("live").textContent;
});
// What a canvas shows.
const drawn = selector => page.evaluate(async selector => {
  await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
  return document.querySelector(selector).toDataURL();
}, selector);
const shot = async name => { if (shots) await page.screenshot({ path: `${shots}/${name}.png`, fullPage: true }); };
const canvases = ["#views figure:first-child canvas", "#scene", ".plot canvas"];
const all = () => Promise.all(canvases.map(drawn));
async function changes(what, selectors, act) {
  const before = await Promise.all(selectors.map(drawn));
  await act();
  const after = await Promise.all(selectors.map(drawn));
  selectors.forEach((selector, index) => assert.ok(before[index] !== after[index], `${what}: ${selector} shows the same`));
}

// Keys.
assert.match(await live(), /^Frame 0 \(0\.00 s\)\. IoU 0\.\d{3}/);
await changes("right", canvases, () => page.keyboard.press("ArrowRight"));
assert.match(await live(), /^Frame 1 /);
for (const [key, frame] of [["ArrowUp", 11], ["ArrowDown", 1], ["End", 29], ["ArrowRight", 29], ["Home", 0], ["ArrowLeft", 0]]) {
  await page.keyboard.press(key);
  await page.waitForFunction(frame => document.getElementById("live").textContent.startsWith(`Frame ${frame} `), frame);
}
await page.keyboard.press("Space");
assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
await page.waitForFunction(() => !document.getElementById("live").textContent.startsWith("Frame 0 "));
await page.keyboard.press("Home");
assert.equal(await page.getAttribute("#play", "aria-pressed"), "false");

// A frame without a picture says which has one, and leads there.
await page.keyboard.press("ArrowRight");
await page.waitForFunction(() => !document.getElementById("nearest").classList.contains("is-here"));
assert.match(await page.textContent("#nearest span"), /nearest: 0$/);
await page.click("#nearest button");
assert.match(await live(), /^Frame 0 /);

// What is shown of a camera, a joint, the scene from elsewhere.
await changes("limbs", [canvases[0]], () => page.check("input[value=limbs]"));
await changes("picture", [canvases[0]], () => page.check("input[value=picture]"));
await page.check("input[value=overlay]");
await changes("joint", canvases.slice(0, 2), () => page.selectOption("#joint", { label: "left elbow" }));
await page.selectOption("#joint", "-1");
await page.focus("#scene");
await changes("turned", ["#scene"], () => page.keyboard.press("ArrowLeft"));
assert.match(await live(), /^Frame 0 /, "arrows turn the scene while it has the focus");
const box = await page.locator("#scene").boundingBox();
await changes("dragged", ["#scene"], async () => {
  await page.mouse.move(box.x + 80, box.y + 80);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 90);
  await page.mouse.up();
});

// Steps of a fit.
await changes("step", [canvases[0], "#costs"], async () => {
  await page.focus("#step");
  await page.keyboard.press("Home");
});
assert.match(await live(), /^Frame 0 \(0\.00 s\)\. Step 0 of \d+, stage 1, the start\. Cost /);
await page.click("#back");
assert.match(await live(), /IoU/);

// A curve leads to a frame; so does an address.
const plot = page.locator(".plot canvas").first();
await plot.click({ position: { x: (await plot.boundingBox()).width - 12, y: 40 } });
await page.waitForFunction(() => document.getElementById("live").textContent.startsWith("Frame 29 "));
await page.evaluate(() => { location.hash = "#frame=12"; });
await page.waitForFunction(() => document.getElementById("live").textContent.startsWith("Frame 12 "));

// Every control has a name; headings, tables and landmarks are there.
const names = await page.evaluate(() => [...document.querySelectorAll("button, input, select, canvas, a, [tabindex='0']")].filter(one => one.offsetParent !== null).map(one => {
  const label = one.getAttribute("aria-label") || (one.labels && [...one.labels].map(label => label.textContent).join(" ")) || one.textContent || document.getElementById(one.getAttribute("aria-labelledby") || "")?.textContent;
  return [one.outerHTML.slice(0, 80), (label || "").trim()];
}));
assert.ok(names.length > 30);
for (const [html, name] of names) assert.notEqual(name, "", `without a name: ${html}`);
const tree = await (await context.newCDPSession(page)).send("Accessibility.getFullAXTree");
const told = tree.nodes.filter(node => !node.ignored).map(node => [node.role?.value, node.name?.value || ""]);
for (const role of ["button", "slider", "radio", "combobox", "spinbutton", "link", "image", "application"]) {
  const named = told.filter(([of]) => of === role || (role === "image" && of === "img"));
  assert.ok(named.length > 0, `no ${role}`);
  for (const [, name] of named) assert.notEqual(name, "", `a ${role} without a name`);
}
for (const role of ["main", "banner", "contentinfo", "status", "table", "columnheader", "rowheader"]) assert.ok(told.some(([of]) => of === role), `no ${role}`);
assert.equal(await page.evaluate(() => document.querySelectorAll("h1").length), 1);

// Both themes; their texts on their grounds (WCAG AA).
const contrast = () => page.evaluate(() => {
  const light = colour => {
    const [r, g, b] = colour.match(/[\d.]+/g).slice(0, 3).map(value => value / 255).map(value => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = one => { for (; one; one = one.parentElement) { const colour = getComputedStyle(one).backgroundColor; if (!/, 0\)$/.test(colour)) return colour; } return "rgb(255, 255, 255)"; };
  const poor = [];
  for (const one of document.querySelectorAll("h1, h2, h3, p, th, td, a, button:not(:disabled), label, li, code, kbd, figcaption, b, select, input[type=number], .badge")) {
    if (one.offsetParent === null || one.classList.contains("skip")) continue;
    const [a, b] = [light(getComputedStyle(one).color), light(ground(one))].sort((x, y) => y - x);
    if ((a + 0.05) / (b + 0.05) < 4.5) poor.push(`${one.outerHTML.slice(0, 90)}: ${((a + 0.05) / (b + 0.05)).toFixed(2)}`);
  }
  return poor;
});
const calm = () => page.waitForTimeout(200);
await page.evaluate(() => { location.hash = "#frame=0"; });
await calm();
assert.deepEqual(await contrast(), []);
await shot("dark");
await changes("theme", [canvases[2]], () => page.click("#theme"));
assert.equal(await page.textContent("#theme"), "Dark theme");
await calm();
assert.deepEqual(await contrast(), []);
await shot("light");
await page.click("#theme");

// Narrow.
await page.setViewportSize({ width: 700, height: 900 });
await calm();
assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "scrolls sideways at 700 px");
await shot("narrow");

// The system asks for light, and for less motion.
await page.setViewportSize({ width: 1280, height: 900 });
await page.emulateMedia({ colorScheme: "light", reducedMotion: "reduce" });
const second = await open("hostile.html");
assert.equal(await second.textContent("#theme"), "Light theme");
assert.match(await second.title(), /<\/script><img/);
assert.equal(await second.locator("img").count(), 0);
assert.ok(await second.locator(".note").first().isVisible());
assert.ok(await second.locator("#cameras").isHidden());

assert.deepEqual(errors, []);
assert.deepEqual(requests, []);
await context.close();
console.log(`the page: ${names.length} controls with names, no error, no request`);
