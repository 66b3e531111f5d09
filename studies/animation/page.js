"use strict";
(() => {
  const run = JSON.parse(document.getElementById("run").textContent);
  const at = (id) => document.getElementById(id);
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const time = new Float64Array(bytes(run.time));
  const poses = new Uint16Array(bytes(run.poses)); // frame, body, (x, z, theta)
  const frames = time.length, bodies = run.names.length;
  const DEGREE = 180 / Math.PI;
  const unpack = (coded) => {
    const steps = new Uint16Array(bytes(coded.values));
    return Float64Array.from(steps, (n) => coded.low + n * coded.step);
  };
  const base = run.base.map(unpack);
  const DASHES = [[], [7, 3], [2, 2], [9, 3, 2, 3], [4, 4], [12, 4]];
  const darker = (colour) => "#" + [1, 3, 5].map((i) =>
    Math.round(parseInt(colour.slice(i, i + 2), 16) * 0.78).toString(16).padStart(2, "0")).join("");
  const fill = (b) => run.fills[b % run.fills.length];
  let now = time[0], playing = false, last = null, traced = run.traced.slice();

  // Where body b is at the instant t: (x, z, theta), straight between frames.
  const frameAt = (t) => {
    let low = 0, high = frames - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (time[middle] <= t) low = middle; else high = middle;
    }
    return frames > 1 && t >= time[high] ? high : low;
  };
  const value = (frame, b, i) => run.low[i] + poses[(frame * bodies + b) * 3 + i] * run.step[i];
  const pose = (t, b) => {
    const f = frameAt(t), next = Math.min(f + 1, frames - 1);
    const share = next > f ? (t - time[f]) / (time[next] - time[f]) : 0;
    return [0, 1, 2].map((i) => value(f, b, i) + share * (value(next, b, i) - value(f, b, i)));
  };
  const corners = (t, b) => {
    const [x, z, theta] = pose(t, b), c = Math.cos(theta), s = Math.sin(theta);
    return run.outlines[b].map(([along, up]) => [x + along * c + up * s, z + up * c - along * s]);
  };

  const fitted = (canvas) => {
    const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
    const width = Math.max(1, Math.round(box.width * ratio)), height = Math.max(1, Math.round(box.height * ratio));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, box.width, box.height);
    return [pen, box.width, box.height];
  };
  // From metres to pixels of the scene's canvas.
  const scale = (width, height) => {
    const [x0, x1, z0, z1] = run.view, k = Math.min(width / (x1 - x0), height / (z1 - z0));
    return { k, x: (x) => 0.5 * width + k * (x - 0.5 * (x0 + x1)), z: (z) => height - k * (z - z0) };
  };
  const polygon = (pen, to, points) => {
    pen.beginPath();
    for (const [x, z] of points) pen.lineTo(to.x(x), to.z(z));
    pen.closePath();
  };

  const drawScene = () => {
    const [pen, width, height] = fitted(at("scene")), to = scale(width, height);
    pen.fillStyle = run.ground;
    for (const wall of run.walls) { polygon(pen, to, wall); pen.fill(); }
    if (run.floor) pen.fillRect(0, to.z(0), width, height);
    pen.strokeStyle = "#1b1f24"; pen.lineJoin = "round"; pen.lineWidth = bodies > 50 ? 0.5 : 1;
    for (let b = 0; b < bodies; b++) {
      polygon(pen, to, corners(now, b));
      pen.fillStyle = fill(b); pen.fill(); pen.stroke();
    }
    if (base.length) drawArrow(pen, width, height);
  };
  // The base's horizontal acceleration now, as an arrow whose full length is the largest of the run.
  const drawArrow = (pen, width, height) => {
    const most = base[0].reduce((m, a) => Math.max(m, Math.abs(a)), 0);
    if (!(most > 0)) return;
    const length = 0.2 * width * sampled(base[0], now) / most, x = 0.5 * width, y = height - 10;
    pen.strokeStyle = pen.fillStyle = "#1b1f24"; pen.lineWidth = 2;
    pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + length, y); pen.stroke();
    if (Math.abs(length) < 3) return;
    const tip = Math.sign(length) * Math.min(8, Math.abs(length));
    pen.beginPath(); pen.moveTo(x + length + 0.3 * tip, y); pen.lineTo(x + length - 0.7 * tip, y - 5);
    pen.lineTo(x + length - 0.7 * tip, y + 5); pen.fill();
  };
  const sampled = (values, t) => {
    const f = frameAt(t), next = Math.min(f + 1, frames - 1);
    const share = next > f ? (t - time[f]) / (time[next] - time[f]) : 0;
    return values[f] + share * (values[next] - values[f]);
  };

  // Traces: time from, to of the chosen window around the instant.
  const span = () => {
    const wide = Number(at("window").value), first = time[0], end = time[frames - 1];
    if (!wide || wide >= end - first) return [first, Math.max(end, first + 1e-9)];
    const from = Math.min(Math.max(now - 0.5 * wide, first), end - wide);
    return [from, from + wide];
  };
  const nice = (range) => {
    const rough = range / 5, power = 10 ** Math.floor(Math.log10(rough));
    return power * ([1, 2, 5, 10].find((m) => m * power >= rough) || 10);
  };
  const LEFT = 46, BELOW = 20;
  const drawTrace = (canvas, curves, most) => {
    const [pen, width, height] = fitted(canvas), [from, until] = span();
    const right = width - 6, bottom = height - BELOW;
    const x = (t) => LEFT + (right - LEFT) * (t - from) / (until - from);
    const y = (v) => 0.5 * bottom - (0.5 * bottom - 6) * v / most;
    pen.font = "11px system-ui, sans-serif"; pen.lineWidth = 1; pen.textBaseline = "middle";
    const stepY = nice(2 * most);
    for (let n = -Math.floor(most / stepY); n * stepY <= most; n++) {
      pen.strokeStyle = n ? "#e4e7ea" : "#adb5bd"; pen.fillStyle = "#57606a"; pen.textAlign = "right";
      pen.beginPath(); pen.moveTo(LEFT, y(n * stepY)); pen.lineTo(right, y(n * stepY)); pen.stroke();
      pen.fillText(String(Number((n * stepY).toPrecision(6))).replace("-", "\u2212"), LEFT - 5, y(n * stepY));
    }
    const stepX = nice(until - from);
    pen.textAlign = "center"; pen.fillStyle = "#57606a";
    for (let n = Math.ceil(from / stepX - 1e-9); n * stepX <= until + 1e-9; n++) {
      const label = Number((n * stepX).toPrecision(6)) + " s";
      pen.fillText(label, Math.min(Math.max(x(n * stepX), LEFT + 8), right - 12), bottom + 11);
    }
    pen.save(); pen.beginPath(); pen.rect(LEFT, 0, right - LEFT, bottom); pen.clip();
    const low = Math.max(0, frameAt(from) - 1), high = Math.min(frames - 1, frameAt(until) + 2);
    for (const { at: valueAt, colour, dash } of curves) {
      pen.strokeStyle = colour; pen.setLineDash(dash); pen.lineWidth = 1.3; pen.beginPath();
      for (let f = low; f <= high; f++) pen.lineTo(x(time[f]), y(valueAt(f)));
      pen.stroke();
    }
    pen.setLineDash([]); pen.strokeStyle = "#d1242f"; pen.lineWidth = 1.5;
    pen.beginPath(); pen.moveTo(x(now), 0); pen.lineTo(x(now), bottom); pen.stroke();
    pen.restore();
  };
  const drawTraces = () => {
    const most = base.reduce((m, values) => values.reduce((n, a) => Math.max(n, Math.abs(a)), m), 0) || 1;
    const colours = ["#1b1f24", "#57606a"];
    if (base.length) drawTrace(at("base"), base.map((values, i) => ({ at: (f) => values[f], colour: colours[i], dash: i ? [5, 3] : [] })), most);
    const largest = traced.reduce((m, b) => Math.max(m, run.largest[b]), 0) * DEGREE;
    drawTrace(at("rotation"), traced.map((b, i) => ({
      at: (f) => value(f, b, 2) * DEGREE, colour: darker(fill(b)), dash: DASHES[i % DASHES.length],
    })), Math.min(Math.max(largest * 1.05, 0.01), run.clip_degrees));
  };
  const makeLegend = () => {
    at("legend").replaceChildren(...traced.map((b, i) => {
      const item = document.createElement("li"), name = document.createElement("span"), number = document.createElement("b");
      const key = document.createElementNS("http://www.w3.org/2000/svg", "svg");
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      for (const [k, v] of Object.entries({ x1: 0, x2: 30, y1: 6, y2: 6, stroke: darker(fill(b)), "stroke-width": 2.5,
        "stroke-dasharray": DASHES[i % DASHES.length].join(" ") })) line.setAttribute(k, v);
      key.setAttribute("viewBox", "0 0 30 12"); key.setAttribute("aria-hidden", "true"); key.append(line);
      name.textContent = run.names[b] + " "; number.dataset.body = b;
      item.append(key, name, number);
      return item;
    }));
  };

  const tell = () => {
    at("clock").textContent = now.toFixed(3) + " s";
    at("scrub").setAttribute("aria-valuetext", now.toFixed(3) + " s");
    for (const number of at("legend").querySelectorAll("b")) {
      number.textContent = (pose(now, Number(number.dataset.body))[2] * DEGREE).toFixed(2).replace("-", "\u2212") + "°";
    }
    if (!document.querySelector("details").open && playing) return;
    [...at("places").rows].forEach((row, b) => {
      const [x, z, theta] = pose(now, b);
      [x.toFixed(5), z.toFixed(5), (theta * DEGREE).toFixed(4)].forEach((text, i) => {
        row.cells[i + 1].textContent = text.replace("-", "\u2212");
      });
    });
  };
  const show = () => { drawScene(); drawTraces(); tell(); };
  const go = (t) => {
    now = Math.min(Math.max(t, time[0]), time[frames - 1]);
    at("scrub").value = frameAt(now);
    show();
  };

  const setPlaying = (on) => {
    playing = on; last = null;
    at("play").textContent = on ? "\u275A\u275A" : "\u25B6";
    at("play").setAttribute("aria-label", on ? "Stop" : "Play");
    if (on && now >= time[frames - 1]) now = time[0];
    if (on) requestAnimationFrame(tick); else tell();
  };
  const tick = (stamp) => {
    if (!playing) return;
    const passed = last === null ? 0 : Math.min(0.25, (stamp - last) / 1000);
    last = stamp;
    let next = now + passed * Number(at("speed").value);
    if (next >= time[frames - 1]) {
      if (at("loop").checked) next = time[0];
      else { go(next); setPlaying(false); return; }
    }
    go(next);
    requestAnimationFrame(tick);
  };

  const toggleTrace = (b) => {
    traced = traced.includes(b) ? traced.filter((n) => n !== b) : [...traced, b];
    makeLegend(); show();
  };
  const inside = (points, px, pz) => points.every(([x, z], i) => {
    const [x2, z2] = points[(i + 1) % points.length]; // counter-clockwise: the inside lies to the left
    return (x2 - x) * (pz - z) - (z2 - z) * (px - x) >= 0;
  });
  at("scene").addEventListener("click", (event) => {
    const box = at("scene").getBoundingClientRect(), to = scale(box.width, box.height);
    const x = (event.clientX - box.left - to.x(0)) / to.k, z = (to.z(0) - (event.clientY - box.top)) / to.k;
    for (let b = bodies - 1; b >= 0; b--) if (inside(corners(now, b), x, z)) { toggleTrace(b); return; }
  });
  for (const id of ["base", "rotation"].filter(at)) {
    const seek = (event) => {
      const box = at(id).getBoundingClientRect(), [from, until] = span();
      const share = (event.clientX - box.left - LEFT) / (box.width - 6 - LEFT);
      go(from + Math.min(Math.max(share, 0), 1) * (until - from));
    };
    at(id).addEventListener("pointerdown", (event) => { at(id).setPointerCapture(event.pointerId); seek(event); });
    at(id).addEventListener("pointermove", (event) => { if (event.buttons & 1) seek(event); });
  }
  at("play").addEventListener("click", () => setPlaying(!playing));
  at("scrub").addEventListener("input", () => go(time[Number(at("scrub").value)]));
  at("window").addEventListener("change", show);
  if (at("choose")) at("choose").addEventListener("change", () => {
    if (at("choose").value !== "") toggleTrace(Number(at("choose").value));
    at("choose").value = "";
  });
  for (const button of document.querySelectorAll(".events button")) {
    button.addEventListener("click", () => go(Number(button.dataset.time)));
  }
  document.querySelector("details").addEventListener("toggle", tell);
  const faster = (by) => {
    const select = at("speed");
    select.selectedIndex = Math.min(Math.max(select.selectedIndex + by, 0), select.options.length - 1);
  };
  document.addEventListener("keydown", (event) => {
    if (event.target.matches("select, input, textarea") && event.target.id !== "scrub") return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " " && event.target.matches("button, summary")) return; // the browser presses it
    const frame = frameAt(now), keys = {
      " ": () => setPlaying(!playing),
      ArrowRight: () => go(event.shiftKey ? now + 1 : time[Math.min(frame + 1, frames - 1)]),
      ArrowLeft: () => go(event.shiftKey ? now - 1 : time[Math.max(now > time[frame] ? frame : frame - 1, 0)]),
      Home: () => go(time[0]),
      End: () => go(time[frames - 1]),
      "+": () => faster(1), "=": () => faster(1), "-": () => faster(-1),
    };
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[event.key]();
  });
  window.addEventListener("resize", show);
  makeLegend();
  const asked = /[#&]t=([0-9.]+)/.exec(location.hash);
  go(asked ? Number(asked[1]) : time[0]);
})();
