// Motions at one frequency.

const kept = [...new Set(data.motions.map((each) => each.frequency))].sort((a, b) => a - b);
const STEP = 1 / 16;  // drive periods from one picture of the beam to the next
let turn = 0, playing = null, current = [];

function cached(motion) {
  if (!motion.x.map) {
    for (const name of ["time", "x", "v", "spectrum"]) motion[name] = unpacked(motion[name]);
    motion.section = motion.section.map(unpacked);
    motion.beam = motion.beam ? unpacked(motion.beam) : null;
  }
  return motion;
}

function drawMotion() {
  const frequency = kept[+byId("pick").value], way = byId("way").value;
  byId("picked").textContent = `${short(frequency * FACTOR, 6)} ${data.frequency.unit}`;
  const here = data.motions.filter((each) => each.frequency === frequency && each.way === way && !hiddenCurves.has(title(each)));
  byId("faults").replaceChildren(...here.filter((each) => each.fault).map((each) => element("p", { class: "note" }, `${title(each)}: ${each.fault}`)));
  current = here.filter((each) => !each.fault).map(cached);
  drawHistory(); drawSpectrum(); drawPortrait(); drawBeam(); listNumbers();
}

const own = (motion) => ({ label: fidelity[motion.fidelity].label, stroke: fidelity[motion.fidelity].colour, dash: fidelity[motion.fidelity].dash, width: 1.5, spanGaps: true, points: { show: false }, value: (plot, value) => short(value) });

function joined(motions, xs, ys) {
  return uPlot.join(motions.map((each, index) => [increasing(xs(each)), ys(each)]));
}
function increasing(values) {
  let last = -Infinity;
  return values.map((value) => (last = value > last ? value : last + 1e-9));
}

function drawHistory() {
  const host = byId("history");
  if (!current.length) return host.replaceChildren();
  const columns = joined(current, (each) => each.time, (each) => each.x.map((value) => value * data.output.factor));
  chart(host, [{ label: "Time in drive periods", value: (plot, value) => short(value) }, ...current.map(own)], columns, [{ ...axis("Time in drive periods"), size: 44 }, axis(withUnit(data.output.name, data.output.unit))], { height: 250, words: "Displacement of the output over time" });
}

// One strip a fidelity, lines as stems: spectra do not cover one another.
function drawSpectrum() {
  const host = byId("spectrum"), decades = 6, count = current.length;
  host.replaceChildren();
  byId("spectrum-unit").textContent = withUnit("amplitude", data.output.unit);
  if (!count) return;
  const places = Array.from({ length: current[0].spectrum.length }, (_, index) => (index * data.lines) / (current[0].spectrum.length - 1));
  const shift = Math.log10(data.output.factor), top = Math.max(...current.flatMap((each) => each.spectrum)) + shift;
  const powers = [];
  for (let power = Math.ceil((top - decades) / 2) * 2; power <= top + 0.5; power += 2) powers.push(power);
  current.forEach((each, at) => {
    const strip = element("div", { class: "chart" }), last = at === count - 1, own = fidelity[each.fidelity];
    host.append(strip);
    const across = last ? { ...axis("Multiple of the drive frequency"), size: 44 } : { ...axis(null), size: 8, values: (plot, splits) => splits.map(() => "") };
    const up = { ...axis(null), size: 50, splits: () => powers, values: (plot, splits) => splits.map((value) => `1e${value}`) };
    const values = each.spectrum.map((value) => (value + shift <= top - decades ? null : value + shift));
    const draw = [(plot) => within(plot, (pen) => stems(plot, pen, own))];
    const scales = { x: { time: false, range: () => [-0.1, data.lines + 0.1] }, y: { range: () => [top - decades, top + 0.5] } };
    chart(strip, [{}, { ...unjoined, label: own.label, stroke: own.colour }], [places, values], [across, up], { height: last ? 150 : 90, legend: false, hooks: { draw }, scales, cursor: { show: false }, words: `Spectrum of the output: ${own.label}` });
  });
}

function stems(plot, pen, own) {
  pen.strokeStyle = pen.fillStyle = own.colour;
  pen.lineWidth = 1.2 * devicePixelRatio;
  pen.beginPath();
  plot.data[1].forEach((value, at) => {
    if (value === null) return;
    const x = plot.valToPos(plot.data[0][at], "x", true);
    pen.moveTo(x, plot.bbox.top + plot.bbox.height);
    pen.lineTo(x, plot.valToPos(value, "y", true));
  });
  pen.stroke();
  pen.font = `600 ${12 * devicePixelRatio}px system-ui, sans-serif`;
  pen.textAlign = "right";
  pen.fillText(own.label, plot.bbox.left + plot.bbox.width - 4 * devicePixelRatio, plot.bbox.top + 12 * devicePixelRatio);
}

function spanOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  const room = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - room, high + room];
}

function ticks(low, high) {
  const rough = (high - low) / 5, size = 10 ** Math.floor(Math.log10(rough));
  const step = size * [1, 2, 5, 10].find((each) => each * size >= rough);
  const found = [];
  for (let at = Math.ceil(low / step); at * step <= high; at += 1) found.push(at * step);
  return found;
}

function drawPortrait() {
  const svg = byId("portrait"), [width, height, left, bottom] = [480, 300, 62, 40];
  svg.replaceChildren();
  if (!current.length) return;
  const [low, high] = spanOf(current.flatMap((each) => each.x)), [slow, fast] = spanOf(current.flatMap((each) => each.v));
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - 10);
  const y = (value) => height - bottom - ((value - slow) / (fast - slow)) * (height - bottom - 10);
  svg.append(drawn("rect", { x: left, y: 10, width: width - left - 10, height: height - bottom - 10, fill: "none", stroke: "#9aa5b1" }));
  for (const at of ticks(low * data.output.factor, high * data.output.factor)) svg.append(drawn("text", { x: x(at / data.output.factor), y: height - bottom + 15 }, short(at, 6)));
  for (const at of ticks(slow * data.speed.factor, fast * data.speed.factor)) {
    const mark = drawn("text", { x: left - 6, y: y(at / data.speed.factor) + 4 }, short(at, 6));
    mark.style.textAnchor = "end";
    svg.append(mark);
  }
  svg.append(drawn("text", { x: (left + width) / 2, y: height - 6 }, withUnit("displacement", data.output.unit) + " — velocity" + (data.speed.unit ? ` (${data.speed.unit})` : "") + " upward"));
  for (const each of current) {
    const colour = fidelity[each.fidelity].colour;
    svg.append(drawn("path", { d: each.x.map((value, at) => `${at ? "L" : "M"}${x(value).toFixed(1)} ${y(each.v[at]).toFixed(1)}`).join(""), fill: "none", stroke: colour, "stroke-width": 1.4, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
    each.section[0].forEach((value, at) => svg.append(drawn("circle", { cx: x(value), cy: y(each.section[1][at]), r: 3, fill: colour })));
  }
}

// The beam in space: base and stops move together, the deflection adds to them.

const metres = (value) => {
  const [unit, factor] = [["m", 1], ["mm", 1e3], ["µm", 1e6], ["nm", 1e9]].find(([, each]) => Math.abs(value) * each >= 0.1) || ["nm", 1e9];
  return `${short(value * factor, 2)} ${unit}`;
};

function drawBeam() {
  const svg = byId("beam"), with_beam = current.filter((each) => each.beam);
  svg.replaceChildren();
  if (!with_beam.length) return svg.append(drawn("text", { x: 240, y: 130 }, "no places along a beam are known here"));
  const deflections = with_beam.flatMap((each) => each.beam), reach = 3 * Math.max(...deflections.map(Math.abs));
  const stops = with_beam.flatMap((each) => each.stops.filter(([, height]) => Math.abs(height) <= reach).map((stop) => [...stop, each]));
  const most = Math.max(...with_beam.map((each) => each.base || 0)), far = with_beam.some((each) => each.stops.some(([, height]) => Math.abs(height) > reach));
  const [low, high] = spanOf(deflections.concat(0, stops.map(([, height]) => height)).flatMap((value) => [value - most, value + most]));
  const y = (value) => 226 - ((value - low) / (high - low)) * 186, x = (place, end) => 20 + (440 * place) / end;
  const base = (each) => (each.base || 0) * Math.sin(2 * Math.PI * turn);
  svg.append(drawn("path", { d: `M20 ${y(0)}H460`, stroke: "#9aa5b1", "stroke-dasharray": "4 3" }));
  for (const each of with_beam) {
    const places = fidelity[each.fidelity].places, count = places.length - 1, end = places[count], now = Math.floor(((turn % each.window) / each.window) * data.frames);
    const shown = [0, ...each.beam.slice(now * count, (now + 1) * count)];
    const from = fidelity[each.fidelity].held ? 0 : 1;
    const points = places.slice(from).map((place, at) => `${x(place, end).toFixed(1)},${y(shown[at + from] + base(each)).toFixed(1)}`);
    svg.append(drawn("polyline", { points: points.join(" "), fill: "none", stroke: fidelity[each.fidelity].colour, "stroke-width": 2.2, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
  }
  for (const [place, height, side, each] of stops) {
    const places = fidelity[each.fidelity].places, tip = `${x(place, places[places.length - 1]).toFixed(1)} ${y(height + base(each)).toFixed(1)}`;
    svg.append(drawn("path", { class: "stop", d: `M${tip}l-5 ${-9 * side}h10z` }));
  }
  if (most > 0) svg.append(drawn("rect", { class: "wall", x: 10, y: (y(base(with_beam[0])) - 14).toFixed(1), width: 8, height: 28 }));
  const said = [`${short(turn % 12, 4)} drive periods`, `deflections ${metres(Math.min(...deflections))} … ${metres(Math.max(...deflections))}`];
  svg.append(drawn("text", { x: 240, y: 14 }, said.join(", ")));
  const frame = most > 0 ? `base ± ${metres(most)}` : with_beam.some((each) => each.base === null) ? "seen from the base" : "base at rest";
  svg.append(drawn("text", { x: 240, y: 254 }, `${frame}${far ? "; a stop is beyond the figure" : with_beam.some((each) => !each.stops.length) ? "; the stop, on the opposite beam, is not shown" : ""}; beam not to this scale`));
}

function listNumbers() {
  const table = byId("numbers");
  table.replaceChildren(element("caption", {}, "Numbers of these motions"));
  const head = element("tr");
  for (const name of ["fidelity", "repeats after (drive periods)", "impacts shown", withUnit("velocities before impact", data.contact_speed.unit), "modes from 2 on, share of energy"]) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const each of current) {
    const row = element("tr"), curve = data.curves.find((one) => one.fidelity === each.fidelity && one.way === each.way);
    const period = curve.values.period[curve.frequency.indexOf(each.frequency)];
    const cells = [period === 0 ? "does not" : period === -1 ? "1, no contact" : short(period), String(each.impacts.length), each.impacts.slice(0, 6).map((hit) => short(hit[1] * data.contact_speed.factor, 3)).join(", ") || "–", each.shares.length > 1 ? `${short(100 * each.shares.slice(1).reduce((a, b) => a + b, 0), 3)} %` : "–"];
    row.append(element("th", { scope: "row" }, fidelity[each.fidelity].label), ...cells.map((text) => element("td", {}, text)));
    body.append(row);
  }
  const top = element("thead");
  top.append(head);
  table.append(top, body);
}

function play() {
  const button = byId("play");
  if (playing) { clearInterval(playing); playing = null; } else playing = setInterval(() => { turn = (turn + STEP) % 12; drawBeam(); }, 90);
  button.setAttribute("aria-pressed", String(Boolean(playing)));
  button.textContent = playing ? "Pause" : "Play";
}
