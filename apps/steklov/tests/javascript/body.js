// Runs the script of a page of `steklov report` without a browser, and asks its functions what can be known of them.
// usage: node body.js PAGE.html
"use strict";
const assert = require("node:assert");
const page = require("node:fs").readFileSync(process.argv[2], "utf8");
const data = JSON.parse(page.match(/<script type="application\/json" id="data">([^]*?)<\/script>/)[1]);
const script = page.match(/<script>([^]*?)<\/script>/)[1];
const names = "decoded, moved, weights, find, interpolated, areas, interval, principal, palette, paint, words, FIELDS";
const js = new Function(`${script}; return { ${names} };`)();
const near = (a, b, tol) => assert.ok(Math.abs(a - b) <= tol, `${a} is not ${b}`);

// a block of 2 by 1: every point inside is found, and linear fields are interpolated exactly
const body = js.decoded(data);
for (const field of ["ux", "uy", "xx", "yy", "xy", "mises"]) assert.strictEqual(body[field].length, body.x.length);
let seed = 1;
const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
for (let k = 0; k < 200; k++) {
  const [qx, qy] = [2 * random(), random()], place = js.find(body.triangles, body.x, body.y, qx, qy);
  near(js.interpolated(body.x, place), qx, 1e-6);
  near(js.interpolated(body.y, place), qy, 1e-6);
  near(js.interpolated(body.x.map((x, i) => 3 - x + 2 * body.y[i]), place), 3 - qx + 2 * qy, 1e-5);
}
for (const [qx, qy] of [[-0.1, 0.5], [2.1, 0.5], [1, -0.1], [1, 1.1]]) assert.strictEqual(js.find(body.triangles, body.x, body.y, qx, qy), null);
const [x, y] = js.moved(body, 7);
body.x.forEach((v, i) => { near(x[i], v + 7 * body.ux[i], 1e-12); near(y[i], body.y[i] + 7 * body.uy[i], 1e-12); });

// principal stresses are eigenvalues: sum and product are trace and determinant
const [larger, smaller] = js.principal(3, -1, 2);
near(larger + smaller, 2, 1e-14);
near(larger * smaller, -3 - 4, 1e-13);

// colours: from 0, with both signs, past a singular point, all equal
assert.deepStrictEqual(js.interval([1, 2, 4, NaN, Infinity]), [0, 4]);
assert.deepStrictEqual(js.interval([-1, 2]), [-1, 2]);
const values = Array.from({ length: 1000 }, (_, k) => k / 999);
const [, high] = js.interval([...values, 1e6]);
assert.ok(high > 1 && high < 2, high);
// as many points about a singular one as elsewhere, on little area
const [, wide] = js.interval([...values, ...values.map((v) => 1e4 * v)], [...values.map(() => 1), ...values.map(() => 1e-6)]);
assert.ok(wide > 1 && wide < 2, wide);
assert.deepStrictEqual(Array.from(js.areas({ x: [0, 2, 2, 0], y: [0, 0, 1, 1], triangles: new Uint16Array([0, 1, 2, 0, 2, 3]) })), [4, 2, 4, 2]);
const [low, top] = js.interval([5, 5, 5]);
assert.ok(low < 5 && top > 5);

// a square of two triangles is painted once, all of it and nothing else, by a linear field
const [width, height] = [40, 30], pixels = new Uint32Array(width * height), colours = Uint32Array.from({ length: 256 }, (_, k) => k + 1);
js.paint(pixels, width, height, new Uint16Array([0, 1, 2, 0, 2, 3]), [5, 25, 25, 5], [4, 4, 24, 24], [0, 1, 1, 0], [0, 1], colours);
for (let row = 0; row < height; row++) {
  for (let column = 0; column < width; column++) {
    const inside = column >= 5 && column < 25 && row >= 4 && row < 24, is = pixels[row * width + column];
    if (inside) near(is, 1 + 256 * (column + 0.5 - 5) / 20, 1.01);
    else assert.strictEqual(is, 0);
  }
}
assert.strictEqual(new Set(js.palette()).size > 200, true);
assert.match(js.words(body, js.find(body.triangles, body.x, body.y, 1, 0.5)), /x = 1, y = 0\.5\n.*\nstress: xx /);
assert.strictEqual(js.FIELDS.length, 9);
console.log("the script is right");
