// View: motions at the picked frequency: beam, history, phase portrait, spectrum, numbers.
import { address, byId, drawn, element, on } from "./state.js";
import { axis, chart, lines, svgOf } from "./chart.js";
import { increasing, metres, short, spanOf, unpacked, withUnit } from "./numbers.js";
import { alone, csv, offer } from "./saving.js";
import { colour, data, fidelity, inUnits, isShown, kept, pick, picked, place, title } from "./result.js";

const STEP = 1 / 16;  // drive periods from one picture of the beam to the next
let turn = 0, playing = null, current = [];

function ready(motion) {
  if (!motion.x.map) {
    for (const name of ["time", "x", "v", "spectrum"]) motion[name] = unpacked(motion[name]);
    motion.section = motion.section.map(unpacked);
    motion.beam = motion.beam ? unpacked(motion.beam) : null;
  }
  return motion;
}

function draw() {
  const way = byId("way").value, here = data.motions.filter((each) => each.frequency === picked() && each.way === way && isShown(each));
  byId("pick").value = String(place());
  byId("pick").setAttribute("aria-valuetext", inUnits(picked()));
  byId("picked").textContent = inUnits(picked());
  byId("faults").replaceChildren(...here.filter((each) => each.fault).map((each) => element("p", { class: "note" }, `${title(each)}: ${each.fault}`)));
  current = here.filter((each) => !each.fault).map(ready);
  drawHistory(); drawSpectrum(); drawPortrait(); drawBeam(); listNumbers();
}

const dashOf = (each) => fidelity[each.fidelity].dash;
const labelOf = (each) => fidelity[each.fidelity].label;
const dashes = (each) => ({ fill: "none", stroke: colour(each), "stroke-dasharray": dashOf(each).join(" ") });
const entry = (each) => ({ label: labelOf(each), stroke: () => colour(each), value: (plot, value) => short(value) });
const charts = { history: [], portrait: [], spectrum: [], beam: data.motions.some((each) => each.beam) };

function drawHistory() {
  const host = byId("history"), out = data.output;
  host.replaceChildren();
  charts.history = [];
  if (!current.length) return;
  const columns = uPlot.join(current.map((each) => [increasing(each.time), each.x.map((value) => value * out.factor)]));
  const series = [{ label: "Time in drive periods", value: (plot, value) => short(value) }, ...current.map(entry)];
  const paint = (pen, at) => current.forEach((each) => lines(pen, at, each.time, each.x.map((value) => value * out.factor), { colour: colour(each), dash: dashOf(each) }));
  charts.history = [chart(host, { words: "Displacement of the output over time", height: 250, series, columns, axes: [{ ...axis("Time in drive periods"), size: 44 }, axis(withUnit(out.name, out.unit))], draw: paint })];
}

const multiple = (each, index) => (index * data.lines) / (each.spectrum.length - 1);

// One strip a fidelity, lines as stems: spectra do not cover one another.
function drawSpectrum() {
  const host = byId("spectrum"), decades = 6;
  host.replaceChildren();
  charts.spectrum = [];
  byId("spectrum-unit").textContent = withUnit("amplitude", data.output.unit);
  if (!current.length) return;
  const shift = Math.log10(data.output.factor), top = Math.max(...current.flatMap((each) => each.spectrum)) + shift, powers = [];
  for (let power = Math.ceil((top - decades) / 2) * 2; power <= top + 0.5; power += 2) powers.push(power);
  charts.spectrum = current.map((each, at) => {
    const strip = element("div", { class: "chart" }), last = at === current.length - 1;
    host.append(strip);
    const across = last ? { ...axis("Multiple of the drive frequency"), size: 44 } : { ...axis(null), size: 8, values: (plot, splits) => splits.map(() => "") };
    const up = { ...axis(null), size: 50, splits: () => powers, values: (plot, splits) => splits.map((value) => `1e${value}`) };
    const values = each.spectrum.map((value) => (value + shift <= top - decades ? null : value + shift));
    const scales = { x: { time: false, range: () => [-0.1, data.lines + 0.1] }, y: { range: () => [top - decades, top + 0.5] } };
    const columns = [values.map((_, index) => multiple(each, index)), values];
    return chart(strip, { words: `Spectrum of the output: ${labelOf(each)}`, height: last ? 150 : 90, series: [{}, { label: labelOf(each) }], columns, axes: [across, up], legend: false, scales, cursor: { show: false }, draw: (pen, frame) => stems(pen, frame, columns, each) });
  });
}

function stems(pen, at, [places, values], each) {
  lines(pen, at, places.flatMap((x) => [x, x, x]), values.flatMap((value) => (value === null ? [null, null, null] : [at.scales.y.min, value, null])), { colour: colour(each), width: 1.2 });
  [pen.fillStyle, pen.textAlign, pen.font] = [colour(each), "right", `600 ${12 * at.ratio}px system-ui, sans-serif`];
  pen.fillText(labelOf(each), at.left + at.width - 4 * at.ratio, at.top + 12 * at.ratio);
}

function drawPortrait() {
  const { output, speed } = data, xs = current.map((each) => each.x.map((value) => value * output.factor)), vs = current.map((each) => each.v.map((value) => value * speed.factor));
  byId("portrait").replaceChildren();
  charts.portrait = [];
  if (!current.length) return;
  const across = spanOf(xs.flat()), up = spanOf(vs.flat());
  const paint = (pen, at) => current.forEach((each, index) => {
    lines(pen, at, xs[index], vs[index], { colour: colour(each), dash: dashOf(each) });
    pen.fillStyle = colour(each);
    each.section[0].forEach((value, place) => { pen.beginPath(); pen.arc(at.x(value * output.factor), at.y(each.section[1][place] * speed.factor), 3 * at.ratio, 0, 7); pen.fill(); });
  });
  const axes = [{ ...axis(withUnit(output.name, output.unit)), size: 44 }, axis(withUnit("velocity", speed.unit))];
  charts.portrait = [chart(byId("portrait"), { words: "Phase portrait: velocity against displacement", height: 300, series: [{}, ...current.map(entry)], columns: [across, ...current.map(() => up)], axes, legend: false, scales: { x: { time: false, range: () => across }, y: { range: () => up } }, cursor: { show: false }, draw: paint })];
}

const shapeAt = (each, frame) => { const count = fidelity[each.fidelity].places.length - 1; return [0, ...each.beam.slice(frame * count, (frame + 1) * count)]; };

// The beam in space: base and stops move together, the deflection adds to them.
function drawBeam() {
  const svg = byId("beam"), bent = current.filter((each) => each.beam);
  svg.replaceChildren();
  if (!bent.length) return svg.append(drawn("text", { class: "middle", x: 240, y: 130 }, "no places along a beam are known here"));
  const deflections = bent.flatMap((each) => each.beam), reach = 3 * Math.max(...deflections.map(Math.abs));
  const stops = bent.flatMap((each) => each.stops.filter(([, height]) => Math.abs(height) <= reach).map((stop) => [...stop, each]));
  const most = Math.max(...bent.map((each) => each.base || 0)), far = bent.some((each) => each.stops.some(([, height]) => Math.abs(height) > reach));
  const [low, high] = spanOf(deflections.concat(0, stops.map(([, height]) => height)).flatMap((value) => [value - most, value + most]));
  const y = (value) => 226 - ((value - low) / (high - low)) * 186, x = (each, at) => 20 + (440 * at) / fidelity[each.fidelity].places.at(-1);
  const base = (each) => (each.base || 0) * Math.sin(2 * Math.PI * turn);
  svg.append(drawn("path", { d: `M20 ${y(0)}H460`, stroke: "#8a96a3", "stroke-dasharray": "4 3" }));
  for (const each of bent) {
    const shape = shapeAt(each, Math.floor(((turn % each.window) / each.window) * data.frames)), from = fidelity[each.fidelity].held ? 0 : 1;
    const points = fidelity[each.fidelity].places.slice(from).map((at, index) => `${x(each, at).toFixed(1)},${y(shape[index + from] + base(each)).toFixed(1)}`);
    svg.append(drawn("polyline", { ...dashes(each), points: points.join(" "), "stroke-width": 2.2 }));
  }
  for (const [at, height, side, each] of stops) svg.append(drawn("path", { class: "stop", d: `M${x(each, at).toFixed(1)} ${y(height + base(each)).toFixed(1)}l-5 ${-9 * side}h10z` }));
  if (most > 0) svg.append(drawn("rect", { class: "wall", x: 10, y: (y(base(bent[0])) - 14).toFixed(1), width: 8, height: 28 }));
  const write = (text, up) => svg.append(drawn("text", { class: "middle", x: 240, y: up }, text));
  write(`${short(turn % 12, 4)} drive periods, deflections ${metres(Math.min(...deflections))} … ${metres(Math.max(...deflections))}`, 14);
  const frame = most > 0 ? `base ± ${metres(most)}` : bent.some((each) => each.base === null) ? "seen from the base" : "base at rest";
  write(`${frame}${far ? "; a stop is beyond the figure" : bent.some((each) => !each.stops.length) ? "; the stop, on the opposite beam, is not shown" : ""}; beam not to this scale`, 254);
}

function listNumbers() {
  const heads = ["fidelity", "repeats after (drive periods)", "impacts shown", withUnit("velocities before impact", data.contact_speed.unit), "modes from 2 on, share of energy"];
  const head = element("tr"), body = element("tbody"), top = element("thead");
  head.append(...heads.map((name) => element("th", { scope: "col" }, name)));
  for (const each of current) {
    const row = element("tr"), curve = data.curves.find((one) => one.fidelity === each.fidelity && one.way === each.way);
    const period = curve.values.period[curve.frequency.indexOf(each.frequency)];
    const cells = [period === 0 ? "does not" : period === -1 ? "1, no contact" : short(period), String(each.impacts.length), each.impacts.slice(0, 6).map((hit) => short(hit[1] * data.contact_speed.factor, 3)).join(", ") || "–", each.shares.length > 1 ? `${short(100 * each.shares.slice(1).reduce((a, b) => a + b, 0), 3)} %` : "–"];
    row.append(element("th", { scope: "row" }, labelOf(each)), ...cells.map((text) => element("td", {}, text)));
    body.append(row);
  }
  top.append(head);
  byId("numbers").replaceChildren(element("caption", {}, "Numbers of these motions"), top, body);
}

function play() {
  if (playing) { clearInterval(playing); playing = null; } else playing = setInterval(() => { turn = (turn + STEP) % 12; drawBeam(); }, 90);
  byId("play").setAttribute("aria-pressed", String(Boolean(playing)));
  byId("play").textContent = playing ? "Pause" : "Play";
}

// Numbers of the pictures: a row each, of the motions shown.
const table = (heads, rowsOf) => () => csv([["fidelity", ...heads], ...current.flatMap((each) => rowsOf(each).map((row) => [labelOf(each), ...row]))]);

function offerAll() {
  const { output, speed } = data, at = () => `${document.title}, ${inUnits(picked())}`;
  const moving = table(["time (drive periods)", withUnit(output.name, output.unit), withUnit("velocity", speed.unit)], (each) => each.time.map((time, index) => [time, each.x[index] * output.factor, each.v[index] * speed.factor]));
  const spectrum = table(["multiple of the drive frequency", withUnit("amplitude", output.unit)], (each) => each.spectrum.map((value, index) => [multiple(each, index), 10 ** value * output.factor]));
  const beam = table(["time (drive periods)", "place (m)", "deflection (m)"], (each) => (each.beam ? Array.from({ length: data.frames }, (_, frame) => shapeAt(each, frame).map((value, index) => [(frame * each.window) / data.frames, fidelity[each.fidelity].places[index], value])).flat() : []));
  if (charts.beam) offer(byId("beam"), "beam", { csv: beam, svg: () => { drawBeam(); return alone(byId("beam")); } });
  offer(byId("history"), "displacement over time", { csv: moving, svg: () => svgOf(charts.history, at()) });
  offer(byId("portrait"), "phase portrait", { csv: moving, svg: () => svgOf(charts.portrait, at()) });
  offer(byId("spectrum"), "spectrum", { csv: spectrum, svg: () => svgOf(charts.spectrum, at()) });
}

if (kept.length) {
  for (const way of new Set(data.curves.map((each) => each.way))) byId("way").append(element("option", { value: way }, way));
  if (data.curves.some((each) => each.way === address.get("way"))) byId("way").value = address.get("way");
  byId("way").addEventListener("change", () => { address.set("way", byId("way").value); draw(); });
  byId("pick").max = String(kept.length - 1);
  byId("pick").addEventListener("input", () => pick(+byId("pick").value));
  byId("play").addEventListener("click", play);
  for (const what of ["picked", "hidden", "theme"]) on(what, draw);
  if (!charts.beam) byId("beam").parentElement.hidden = true;
  draw();
  offerAll();
} else byId("motion").hidden = true;
