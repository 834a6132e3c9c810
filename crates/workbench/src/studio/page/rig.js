// Rig: the model's numbers as sliders, and the simulated curves that follow the hand.

import { curves, post } from "./server.js";
import { Plot, holes, phases } from "./charts.js";
import { at, make, number, readable } from "./studio.js";

/** What is shown of a motion: its label, and how it comes out of the columns. */
export const QUANTITIES = {
  theta_dot: ["disc velocity θ̇₂ [rad/s]", (c) => c.theta_dot],
  theta3_dot: ["gearbox output velocity θ̇₃ [rad/s]", (c) => c.theta3_dot],
  twist: ["twist θ₃ − θ₂ [rad]", (c) => c.theta3 && c.theta && c.theta3.map((value, row) => value - c.theta[row])],
  theta: ["disc angle θ₂ [rad]", (c) => c.theta],
  theta3: ["gearbox output angle θ₃ [rad]", (c) => c.theta3],
  i: ["armature current i [A]", (c) => c.i],
  theta1_dot: ["disc D1 velocity θ̇₁ [rad/s]", (c) => c.theta1_dot],
  T_f: ["friction torque T_f [N m], simulated alone", (c) => c.T_f],
};

/** Share of a number to each side of it that a slider has. */
const REACH = 0.5;
const STEPS = 1000;
/** Time of a run from the measured starts above which the best starts are not looked for: that takes twelve times as long [ms]. */
const DEAR = 150;
/** Time after the last movement until windows start where they fit best. */
const SETTLE = 350;
const HELD = { speed: 55, force: 50, force1: 50, time: 60 };

let plot;
let rest;
let working = false;
let wanted = null;
let arrived = null;
let settling;
/** Times at which curves were drawn [ms]. */
const frames = [];
const trips = [];
/** Times of runs from the measured starts, by record [ms]. */
const costs = {};

export function begin(app) {
  plot = new Plot(at("rig-plot"), { x: "time [s]", y: "", series: [], height: 290, name: "Measured and simulated over time" });
  rest = new Plot(at("rest-plot"), { x: "time [s]", y: "", series: [], height: 180, name: "Measured less simulated over time" });
  at("model").addEventListener("change", () => {
    app.look({ model: at("model").value });
    refresh(app);
    follow(app, true);
  });
  at("drive").addEventListener("change", () => change(app, { drive: at("drive").value }));
  at("rig-record").addEventListener("change", () => change(app, { record: at("rig-record").value }));
  at("quantity").addEventListener("change", () => change(app, { quantity: at("quantity").value }));
  for (const [id, key] of [["held-speed", "speed"], ["held-force", "force"], ["held-force-1", "force1"], ["held-time", "time"]]) {
    at(id).addEventListener("input", () => change(app, { held: { ...HELD, ...app.view.held, [key]: Number(at(id).value) } }));
  }
  at("sliders").addEventListener("submit", (event) => event.preventDefault());
}

function change(app, view) {
  app.look(view);
  controls(app);
  follow(app, true);
}

/** The model that is looked at. */
export function model(app) {
  const { models } = app.told;
  return models.find((one) => one.key === app.view.model) ?? models[0];
}

/** Whether the run goes through a record. */
function ofRecord(app) {
  return app.view.drive !== "held" && usable(app).length > 0;
}

function usable(app) {
  return app.told.records.filter((one) => !one.problem);
}

export function refresh(app) {
  const { models } = app.told;
  at("model").replaceChildren(...models.map((one) => make("option", { value: one.key, textContent: one.label })));
  at("model").value = model(app).key;
  app.view.drive ??= "windows";
  at("rig-record").replaceChildren(...usable(app).map((one) => make("option", { value: one.name, textContent: one.name })));
  at("quantity").replaceChildren(...Object.entries(QUANTITIES).map(([value, [textContent]]) => make("option", { value, textContent })));
  controls(app);
  sliders(app);
}

function controls(app) {
  const isOf = ofRecord(app);
  if (!usable(app).some((one) => one.name === app.view.record)) {
    app.view.record = usable(app)[0]?.name ?? app.view.record;
  }
  at("rig-record").value = app.view.record ?? "";
  at("quantity").value = app.view.quantity ?? "theta_dot";
  at("drive").value = isOf ? app.view.drive : "held";
  for (const option of at("drive").options) {
    option.disabled = option.value !== "held" && usable(app).length === 0;
  }
  document.querySelectorAll("#panel-rig .of-record").forEach((node) => { node.hidden = !isOf && node.querySelector("#quantity") === null; });
  document.querySelectorAll("#panel-rig .of-held").forEach((node) => { node.hidden = isOf; });
  at("held-outer").hidden ||= model(app).kind !== "full";
  const held = { ...HELD, ...app.view.held };
  for (const [id, value] of [["held-speed", held.speed], ["held-force", held.force], ["held-force-1", held.force1], ["held-time", held.time]]) {
    if (document.activeElement !== at(id)) {
      at(id).value = value;
    }
  }
}

/** Ends of a parameter's slider. */
function ends(parameter, now) {
  const { value, minimum, maximum, unit } = parameter;
  let [low, high] = value === 0 ? [-1, 1] : [value - REACH * Math.abs(value), value + REACH * Math.abs(value)];
  if (unit === "rad" && Math.abs(value) <= 2 * Math.PI) {
    [low, high] = [Math.min(0, value), 2 * Math.PI];
  }
  [low, high] = [Math.min(low, now), Math.max(high, now)];
  return [minimum === null ? low : Math.max(low, minimum), maximum === null ? high : Math.min(high, maximum)];
}

function own(app) {
  const { key } = model(app);
  app.settings[key] ??= {};
  return app.settings[key];
}

function sliders(app) {
  const form = at("sliders");
  const { parameters, problem, kind, key } = model(app);
  if (problem || parameters.length === 0) {
    form.replaceChildren(make("p", {
      className: problem ? "problem" : "hint",
      textContent: problem ?? `This model is a ${kind}'s, which has no sliders here. The diagnosis takes it as it is.`,
    }));
    return;
  }
  const buttons = make("p", { className: "controls" });
  const back = make("button", { type: "button", textContent: "Back to the model's numbers" });
  back.addEventListener("click", () => {
    app.settings[key] = {};
    app.keep({ settings: [key, {}] });
    sliders(app);
    follow(app, true);
  });
  const believe = make("button", { type: "button", textContent: "Believe these numbers" });
  believe.addEventListener("click", () => app.attempt(async () => {
    await post("api/believe", [key, own(app)]);
    app.settings.believed = {};
    app.look({ model: "believed" });
    await app.refresh();
  }));
  buttons.append(back, believe);
  if (app.told.choices.believed !== "case") {
    const original = make("button", { type: "button", textContent: "Believe the case's own model again" });
    original.addEventListener("click", () => app.attempt(async () => {
      await post("api/believe", null);
      app.settings.believed = {};
      app.look({ model: "believed" });
      await app.refresh();
    }));
    buttons.append(original);
  }
  const groups = new Map();
  for (const parameter of parameters) {
    if (!groups.has(parameter.section)) {
      groups.set(parameter.section, make("fieldset", {}, make("legend", { textContent: readable(parameter.section) })));
    }
    groups.get(parameter.section).append(slider(app, parameter));
  }
  form.replaceChildren(buttons, ...groups.values());
}

function slider(app, parameter) {
  const settings = own(app);
  const now = settings[parameter.name] ?? parameter.value;
  const id = `p-${parameter.name.replaceAll(".", "-")}`;
  const unit = parameter.unit === "1" ? "" : ` [${parameter.unit}]`;
  const known = parameter.deviation ? `, known to ±${number(100 * parameter.deviation, 2)} %` : "";
  const range = make("input", { type: "range", id, min: 0, max: STEPS, step: 1, title: `${parameter.description}; ${parameter.range}` });
  const exact = make("input", { type: "number", step: "any", value: now, "aria-label": `${parameter.name}, exact value` });
  const label = make("label", { textContent: `${parameter.name}${unit}${known}` });
  label.htmlFor = id;
  const row = make("div", { className: "slider" }, label, range, exact);
  let [low, high] = ends(parameter, now);
  const place = (value) => {
    range.value = String(Math.round((STEPS * (value - low)) / (high - low || 1)));
    range.setAttribute("aria-valuetext", `${number(value, 5)} ${parameter.unit}`);
    row.classList.toggle("changed", value !== parameter.value);
  };
  const set = (value) => {
    if (value === parameter.value) {
      delete settings[parameter.name];
    } else {
      settings[parameter.name] = value;
    }
    place(value);
    app.keep({ settings: [model(app).key, settings] });
    follow(app, false);
  };
  range.addEventListener("input", () => {
    const value = Number((low + ((high - low) * Number(range.value)) / STEPS).toPrecision(6));
    exact.value = value;
    set(value);
  });
  exact.addEventListener("input", () => {
    const value = exact.valueAsNumber;
    if (Number.isFinite(value)) {
      [low, high] = ends(parameter, value);
      set(value);
    }
  });
  place(now);
  return row;
}

/** What the studio is asked to run. */
function order(app, best) {
  const { key } = model(app);
  const held = { ...HELD, ...app.view.held };
  const drive = ofRecord(app)
    ? { by: "record", record: app.view.record, windows: app.view.drive === "windows", best }
    : {
        by: "held", speed_rpm: held.speed, normal_force: held.force, duration: held.time, step: 0.01,
        ...(model(app).kind === "full" ? { normal_force_1: held.force1 } : {}),
      };
  return { model: key, settings: own(app), drive };
}

/** Runs what is set now; while a run is under way only the last wish counts. */
export async function follow(app, isSettled, isLast = false) {
  clearTimeout(settling);
  const cost = costs[app.view.record];
  const best = isSettled && cost < DEAR;
  if (ofRecord(app) && app.view.drive === "windows" && !best && !(cost >= DEAR) && !isLast) {
    settling = setTimeout(() => follow(app, true, true), SETTLE);
  }
  wanted = { asked: order(app, best), since: performance.now() };
  if (working || model(app).problem || model(app).parameters.length === 0) {
    return;
  }
  working = true;
  while (wanted !== null) {
    const now = wanted;
    wanted = null;
    try {
      await once(app, now);
    } catch (problem) {
      arrived = null;
      at("fit").textContent = problem.message;
      if (problem.status === 0) {
        app.fail(problem);
      }
    }
  }
  working = false;
}

/** Asks for a run. The next one may be asked for while this one waits for the screen. */
async function once(app, { asked, since }) {
  const { by, record } = asked.drive;
  let { measured } = app;
  if (by === "record" && measured?.key !== measuredKey(app, record)) {
    measured = await curves(`api/records/${encodeURIComponent(record)}`);
    measured.key = measuredKey(app, record);
    measured.stuck = phases(measured.columns.time, measured.columns.stuck);
    measured.seen = {};
  }
  const run = await curves("api/simulate", asked);
  run.isOf = by === "record";
  if (run.isOf && asked.drive.windows && !asked.drive.best) {
    costs[record] = run.milliseconds;
  }
  if (arrived === null) {
    requestAnimationFrame(() => paint(app));
  }
  arrived = { run, measured, asked, since: arrived?.since ?? since };
}

/** Draws what arrived last, with the screen's next frame. */
function paint(app) {
  if (arrived === null) {
    return;
  }
  const { run, measured, asked, since } = arrived;
  arrived = null;
  Object.assign(app, { run, measured });
  draw(app);
  fit(app, asked);
  app.dispatch?.();
  // uPlot draws in a microtask of its own, which comes before this one.
  queueMicrotask(() => {
    const end = performance.now();
    trips.push(end - since);
    frames.push(end);
    measure(run.milliseconds);
  });
}

function measuredKey(app, record) {
  const one = app.told.records.find((own) => own.name === record);
  return JSON.stringify([record, one?.rows, one?.end, app.told.choices.columns]);
}

/** The page measures itself: how long from the hand to the curve, and how often a second. */
function measure(milliseconds) {
  while (trips.length > 30) {
    trips.shift();
  }
  while (frames.length > 0 && frames[0] < frames[frames.length - 1] - 1000) {
    frames.shift();
  }
  const sorted = [...trips].sort((a, b) => a - b);
  const median = sorted[Math.floor(sorted.length / 2)];
  const span = frames[frames.length - 1] - frames[0];
  const rate = frames.length > 2 ? (1000 * (frames.length - 1)) / span : null;
  const line = at("measured");
  line.textContent = `computed in ${number(milliseconds, 2)} ms; from the hand to the curve ${number(median, 2)} ms`
    + `${rate === null ? "" : `; ${number(rate, 2)} curves a second`}`;
  line.dataset.computed = milliseconds;
  line.dataset.trip = median;
  line.dataset.rate = rate ?? "";
}

function fit(app, asked) {
  const { run } = app;
  const line = at("fit");
  if (!run.isOf) {
    line.textContent = `Motion: ${readable(run.motion)}${run.frequency ? `, ${number(run.frequency)} Hz` : ""}, sticking `
      + `${number(100 * run.stick_fraction, 3)} % of the time.`;
    return;
  }
  if (asked.drive.windows) {
    line.textContent = `Window error: ${number(run.window_error, 3)} standard deviations of the instruments`
      + `${asked.drive.best ? "" : ", from the measured starts"}; noise alone leaves about 1.`;
    line.dataset.error = run.window_error;
    return;
  }
  const [label, of] = QUANTITIES[app.view.quantity ?? "theta_dot"];
  const [one, other] = [of(app.measured.columns), of(run.columns)];
  const both = one && other ? Math.sqrt(one.reduce((sum, value, row) => sum + (value - other[row]) ** 2, 0) / one.length) : null;
  line.textContent = both === null ? "" : `Root mean square error of ${label}: ${number(both)}. One run drifts out of phase however right the model is.`;
}

export function draw(app) {
  const { run, measured } = app;
  if (!run || app.view.tab !== "rig") {
    return;
  }
  const [label, of] = QUANTITIES[app.view.quantity ?? "theta_dot"];
  const simulated = of(run.columns);
  const seen = run.isOf ? of(measured.columns) : undefined;
  const series = [];
  const data = [run.columns.time];
  if (seen) {
    series.push({ label: "measured", colour: "measured" });
    const key = app.view.quantity ?? "theta_dot";
    measured.seen[key] ??= holes(seen);
    data.push(measured.seen[key]);
  }
  if (simulated) {
    series.push({ label: "simulated", colour: "simulated" });
    data.push(holes(simulated));
  }
  at("rig-caption").textContent = `${label}${run.isOf ? `, ${app.view.record}` : ""}`;
  plot.shape({ y: label.match(/\[.*?\]/)?.[0] ?? "", series });
  plot.show(data, run.isOf ? measured.stuck : phases(run.columns.time, run.columns.stuck));
  at("rest-plot").hidden = !(seen && simulated);
  if (seen && simulated) {
    rest.shape({ y: "residual", series: [{ label: "measured less simulated", colour: "second" }] });
    rest.show([run.columns.time, holes(seen.map((value, row) => value - simulated[row]))]);
  }
}

export function shown(app) {
  if (app.told === null) {
    return;
  }
  if (app.view.tab === "rig") {
    controls(app);
    draw(app);
    follow(app, true);
  }
}
