// Opens pages from disk with the network off and tries what people try: every mode, the slider, hovering, small windows.
// Screenshots stay beside the pages. Usage: check.mjs CHROMIUM FOLDER
import { createRequire } from "node:module";
import { mkdirSync } from "node:fs";
import { join } from "node:path";
import assert from "node:assert/strict";

const [executablePath, folder] = process.argv.slice(2);
const { chromium } = createRequire(join(process.env.NODE_PATH, "anchor.js"))("playwright-core");
const shots = join(folder, "screenshots");
mkdirSync(shots, { recursive: true });

const DESKTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };
const SOFTWARE_GL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
const browser = await chromium.launch({ executablePath, args: SOFTWARE_GL });

/** Opens a page offline; whatever it complains about is a failure, and so is any request that leaves the disk. */
async function open(name, viewport, colorScheme = "light") {
  const context = await browser.newContext({ viewport, colorScheme, offline: true, hasTouch: viewport === PHONE });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || complaints.push(request.url()));
  await page.goto(`file://${join(folder, name)}`);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "true", null, { timeout: 30_000 });
  await settled(page);
  return { page, complaints, close: () => context.close() };
}

/** Waits for two frames, after which whatever was asked for is on the screen. */
const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const picture = async (page) => {
  await settled(page);
  return page.locator("#stage").screenshot();
};

/** Colours on the canvas, coarsely. */
async function colours(page) {
  return page.evaluate(async () => {
    window.homeo.draw();
    const canvas = document.getElementById("canvas");
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3]) seen.add(`${data[i] >> 4} ${data[i + 1] >> 4} ${data[i + 2] >> 4}`);
    return seen.size;
  });
}

async function noOverflow(page, name) {
  const over = await page.evaluate(() => {
    const wide = document.documentElement.scrollWidth - innerWidth;
    const clipped = [...document.querySelectorAll("#stage, #panels .panel, .toolbar, #under, .block")].filter((element) => {
      const box = element.getBoundingClientRect();
      return box.left < -1 || box.right > innerWidth + 1 || box.width < 100;
    });
    return { wide, clipped: clipped.map((element) => element.id || element.className) };
  });
  assert.deepEqual(over, { wide: 0, clipped: [] }, `${name}: wider than the window`);
}

/** Every mode and toggle changes what is seen. */
async function everyControl(page, name) {
  let before = await picture(page);
  for (const mode of await page.locator("#modes button").all()) {
    await mode.click();
    const after = await picture(page);
    await page.screenshot({ path: join(shots, `${name}-${await mode.getAttribute("data-key")}.png`) });
    if (await page.evaluate((key) => window.homeo.scene.modes[0] !== key, await mode.getAttribute("data-key"))) {
      assert(!after.equals(before), `${name}: ${await mode.textContent()} shows nothing new`);
    }
    before = after;
  }
  await page.locator("#modes button").first().click();
  for (const toggle of await page.locator("#toggles input").all()) {
    const [off, id] = [await picture(page), await toggle.getAttribute("id")];
    await toggle.click();
    assert(!(await picture(page)).equals(off), `${name}: ${id} changes nothing`);
    await toggle.click();
  }
}

/** Hovering a vertex in the first panel shows its image in every other one. */
async function hovering(page, name) {
  const at = await page.evaluate(() => {
    const { scene, seen } = window.homeo;
    const surface = scene.surfaces[scene.panels[0].surface];
    const panel = document.querySelector(".panel").getBoundingClientRect();
    // The middle of the triangle that faces the viewer best.
    let best = null;
    for (let t = 0; t < surface.triangles; t++) {
      const places = surface.positions.map((p) => [0, 1, 2].map((axis) =>
        [0, 1, 2].reduce((sum, j) => sum + p[3 * surface.corners[3 * t + j] + axis] / 3, 0)));
      const [x, y, away] = seen(0, places);
      if (!best || away < best.away) best = { t, x: panel.left + x, y: panel.top + y, away, places };
    }
    return best;
  });
  const before = await picture(page);
  await page.mouse.move(at.x, at.y);
  await settled(page);
  const hover = await page.evaluate(() => {
    const { hover } = window.homeo.state;
    return hover && { triangle: hover.triangle, places: hover.places, tip: document.getElementById("tip").textContent };
  });
  assert(hover, `${name}: nothing under the pointer`);
  assert(hover.tip.includes("face "), `${name}: the tip says ${hover.tip}`);
  const off = Math.hypot(...hover.places[1].map((x, k) => x - at.places[1][k]));
  assert(off < 0.05, `${name}: the image is ${off} away from where it should be`);
  const after = await picture(page);
  assert(!after.equals(before), `${name}: hovering changes nothing`);
  await page.screenshot({ path: join(shots, `${name}-hover.png`) });
  // The point's colour is where the other panels must show it.
  const shown = await page.evaluate((places) => {
    window.homeo.draw();
    const canvas = document.getElementById("canvas");
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    return window.homeo.scene.panels.slice(1).map((panel, i) => {
      const [x, y] = window.homeo.seen(i + 1, places);
      const [r, g, b] = copy.getImageData((panel.left + x) * panel.density, (panel.top + y) * panel.density, 1, 1).data;
      return r > 150 && g > 110 && b < 140 && r > b + 40;
    });
  }, hover.places);
  assert(shown.every(Boolean), `${name}: the image point is not shown in every panel: ${shown}`);
  await page.mouse.move(2, 2);
}

/** Some mark is in sight, and its name is shown when the pointer is on it. */
async function naming(page, name) {
  const marks = await page.evaluate(() => {
    const panel = document.querySelector(".panel").getBoundingClientRect();
    return window.homeo.scene.marks.map(({ name, places }) => {
      const [x, y] = window.homeo.seen(0, places);
      return { name, x: panel.left + x, y: panel.top + y };
    });
  });
  for (const mark of marks) {
    await page.mouse.move(mark.x, mark.y);
    await settled(page);
    if ((await page.locator("#tip").textContent()).includes(mark.name)) return;
  }
  assert(marks.length === 0, `${name}: no mark shows its name`);
}

async function turning(page, name) {
  const before = await picture(page);
  const panel = await page.locator(".panel").first().boundingBox();
  await page.mouse.move(panel.x + panel.width / 2, panel.y + panel.height * 0.7);
  await page.mouse.down();
  await page.mouse.move(panel.x + panel.width / 2 + 60, panel.y + panel.height * 0.7, { steps: 4 });
  await page.mouse.up();
  await page.mouse.move(2, 2);
  assert(!(await picture(page)).equals(before), `${name}: dragging turns nothing`);
  await page.mouse.move(panel.x + panel.width / 2, panel.y + panel.height / 2);
  await page.mouse.wheel(0, -300);
  await page.locator("#reset").click();
  await page.mouse.move(2, 2);
  assert((await picture(page)).equals(before), `${name}: reset does not lead back`);
}

async function sliding(page, name) {
  const end = await picture(page);
  await page.locator("#slide").fill("0.4");
  const middle = await picture(page);
  assert(!middle.equals(end), `${name}: the slider changes nothing`);
  await page.screenshot({ path: join(shots, `${name}-half.png`) });
  await page.locator("#play").click();
  await page.waitForTimeout(300);
  await page.locator("#play").click();
  assert(!(await picture(page)).equals(middle), `${name}: play does not run`);
  await page.locator("#slide").fill("1");
}

async function report(name) {
  const file = `${name}/report.html`;
  const { page, complaints, close } = await open(file, DESKTOP);
  assert((await colours(page)) > 12, `${name}: the canvas is blank`);
  await noOverflow(page, name);
  await hovering(page, name);
  await naming(page, name);
  await page.mouse.move(2, 2);
  await everyControl(page, name);
  await turning(page, name);
  if (await page.locator("#morph").isVisible()) await sliding(page, name);
  const light = await picture(page);
  await page.locator("#theme").click();
  assert(!(await picture(page)).equals(light), `${name}: the theme does not change`);
  await page.screenshot({ path: join(shots, `${name}-dark.png`) });
  assert.deepEqual(complaints, [], `${name}: complaints`);
  await close();
  const phone = await open(file, PHONE, "dark");
  await noOverflow(phone.page, `${name} on a phone`);
  assert((await colours(phone.page)) > 12, `${name}: the canvas is blank on a phone`);
  await phone.page.screenshot({ path: join(shots, `${name}-phone.png`) });
  assert.deepEqual(phone.complaints, []);
  await phone.close();
  console.log(`${name}: works`);
}

async function batch() {
  const { page, complaints, close } = await open("batch.html", DESKTOP);
  const first = () => page.locator("tbody tr td.job").first().textContent();
  assert.equal(await first(), "map");
  await page.locator("th button[data-key=e_l2]").click();
  await page.locator("th button[data-key=e_l2]").click();
  assert.equal(await first(), "pair 299");
  await page.locator("#status").selectOption("failed");
  assert.match(await page.locator("#count").textContent(), /^43 of 300$/);
  await page.locator("#status").selectOption("");
  await page.locator("#least").fill("3.9");
  assert((await page.locator("tbody tr").count()) < 12);
  await page.locator("#least").fill("");
  await page.locator("#search").fill("map");
  assert.equal(await page.locator("tbody a[href='./map/report.html']").count(), 2);
  const loaded = await page.locator("tbody img").evaluate((image) => image.decode().then(() => image.naturalWidth > 0));
  assert(loaded, "the thumbnail is there");
  await page.locator("#search").fill("");
  await page.screenshot({ path: join(shots, "batch.png") });
  await page.setViewportSize(PHONE);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth - innerWidth), 0);
  assert.deepEqual(complaints, [], "batch: complaints");
  await close();
  console.log("batch: works");
}

async function timeFirstFrame() {
  const times = [];
  for (let i = 0; i < 3; i++) {
    const { page, close } = await open("large/report.html", DESKTOP);
    times.push(Number(await page.evaluate(() => document.documentElement.dataset.firstFrame)));
    await close();
  }
  console.log(`first frame of 2 x 20480 triangles, software GL: ${times.join(", ")} ms after navigation`);
}

try {
  for (const name of ["map", "texture", "diffuse"]) await report(name);
  await batch();
  await timeFirstFrame();
} finally {
  await browser.close();
}
