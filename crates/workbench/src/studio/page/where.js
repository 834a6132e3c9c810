// Where: residuals over every coordinate; samples that are chosen in one plot stand out in all.

import { Plot, holes } from "./charts.js";
import { QUANTITIES, follow } from "./rig.js";
import { at, make, number } from "./studio.js";

const TURN = 2 * Math.PI;
/** Most dots of a cloud: more would hide each other. */
const MOST_DOTS = 4000;

/** Coordinates: label, and how each comes out of what was measured. */
const COORDINATES = {
  time: ["time [s]", (c) => c.time],
  angle: ["disc angle within a turn [rad]", (c) => c.theta?.map((value) => value - TURN * Math.floor(value / TURN))],
  speed: ["disc velocity θ̇₂ [rad/s]", (c) => c.theta_dot],
  twist: ["twist θ₃ − θ₂ [rad]", (c) => QUANTITIES.twist[1](c)],
  force: ["normal force N2 [N]", (c) => c.N2],
};

const plots = {};
let portrait;

export function begin(app) {
  const grid = at("where-plots");
  for (const [key, [label]] of Object.entries(COORDINATES)) {
    const place = make("div");
    grid.append(make("figure", {}, make("figcaption", { textContent: `over ${label.replace(/ \[.*/, "")}` }), place));
    plots[key] = new Plot(place, {
      x: label, y: "residual", series: [], name: `Residual over ${label}`,
      chosen: (span) => brush(app, span === null ? null : { key, span }),
    });
    at("brush-key").append(make("option", { value: key, textContent: label }));
  }
  const place = make("div");
  grid.append(make("figure", {}, make("figcaption", { textContent: "phase portrait" }), place));
  portrait = new Plot(place, {
    x: "twist θ₃ − θ₂ [rad]", y: "θ̇₂ [rad/s]", series: [], name: "Phase portrait, measured and simulated",
    chosen: (span) => brush(app, span === null ? null : { key: "twist", span }),
  });
  at("where-quantity").addEventListener("change", () => {
    app.look({ residual: at("where-quantity").value });
    draw(app);
  });
  for (const id of ["brush-key", "brush-from", "brush-to"]) {
    at(id).addEventListener("change", () => {
      const span = [at("brush-from").valueAsNumber, at("brush-to").valueAsNumber];
      if (span.every(Number.isFinite)) {
        brush(app, { key: at("brush-key").value, span }, true);
      }
    });
  }
  at("brush-clear").addEventListener("click", () => brush(app, null));
  app.dispatch = () => draw(app);
}

function brush(app, chosen, byHand = false) {
  app.look({ brush: chosen });
  if (!byHand) {
    at("brush-from").value = chosen ? number(chosen.span[0], 5).replace("−", "-") : "";
    at("brush-to").value = chosen ? number(chosen.span[1], 5).replace("−", "-") : "";
    at("brush-key").value = chosen?.key ?? "time";
  }
  draw(app);
}

export function refresh(app) {
  const list = Object.entries(QUANTITIES).filter(([key]) => key !== "T_f");
  at("where-quantity").replaceChildren(...list.map(([value, [textContent]]) => make("option", { value, textContent })));
  at("where-quantity").value = app.view.residual ?? "theta_dot";
}

export function shown(app) {
  if (app.told === null || app.view.tab !== "where") {
    return;
  }
  if (app.view.drive === "held" && app.told.records.some((one) => !one.problem)) {
    app.look({ drive: "windows" });
  }
  draw(app);
  follow(app, true);
}

/** Which samples are chosen; null where none are. */
function mask(app) {
  const { brush: chosen } = app.view;
  if (!chosen) {
    return null;
  }
  const values = COORDINATES[chosen.key][1](app.measured.columns);
  return values ? Array.from(values, (value) => value >= chosen.span[0] && value <= chosen.span[1]) : null;
}

/** Rows in the order of a coordinate, thinned out where they are too many. */
function ordered(values) {
  const rows = Array.from(values.keys()).filter((row) => Number.isFinite(values[row]));
  const every = Math.ceil(rows.length / MOST_DOTS);
  return rows.filter((_, place) => place % every === 0).sort((a, b) => values[a] - values[b]);
}

export function draw(app) {
  const { run, measured } = app;
  const isThere = Boolean(run?.isOf && measured);
  at("where-plots").hidden = !isThere;
  if (!isThere || app.view.tab !== "where") {
    at("brushed").textContent = isThere ? "" : "There is no run through a record yet.";
    return;
  }
  const [label, of] = QUANTITIES[app.view.residual ?? "theta_dot"];
  const [seen, simulated] = [of(measured.columns), of(run.columns)];
  if (!seen || !simulated) {
    at("brushed").textContent = `This record has no ${label}.`;
    return;
  }
  const residual = holes(seen.map((value, row) => value - simulated[row]));
  const chosen = mask(app);
  const dots = (name, colour, size) => ({ label: name, colour, points: true, size });
  for (const [key, [, coordinate]] of Object.entries(COORDINATES)) {
    const values = coordinate(measured.columns);
    plots[key].place.parentElement.hidden = !values;
    if (!values) {
      continue;
    }
    const rows = ordered(values);
    plots[key].shape({ y: "residual", series: [dots("residual", "second"), dots("chosen", "chosen", 4)] });
    plots[key].show([
      rows.map((row) => values[row]),
      rows.map((row) => residual[row]),
      rows.map((row) => (chosen?.[row] ? residual[row] : null)),
    ]);
  }
  drawPortrait(measured.columns, run.columns, chosen, dots);
  const some = chosen ? residual.filter((value, row) => chosen[row] && value !== null) : residual.filter((value) => value !== null);
  const size = Math.sqrt(some.reduce((sum, value) => sum + value * value, 0) / some.length);
  const mean = some.reduce((sum, value) => sum + value, 0) / some.length;
  at("brushed").textContent = `${chosen ? `${some.length} samples are chosen` : "All samples"}: mean ${number(mean, 3)}, `
    + `root mean square ${number(size, 3)}.`;
}

/** Both motions in one cloud: their samples have coordinates of their own. */
function drawPortrait(measured, run, chosen, dots) {
  const twist = QUANTITIES.twist[1];
  const [one, other] = [twist(measured), twist(run)];
  const isThere = Boolean(one && other && measured.theta_dot && run.theta_dot);
  portrait.place.parentElement.hidden = !isThere;
  if (!isThere) {
    return;
  }
  const all = [
    ...ordered(one).map((row) => [one[row], measured.theta_dot[row], null, chosen?.[row] ? measured.theta_dot[row] : null]),
    ...ordered(other).map((row) => [other[row], null, run.theta_dot[row], null]),
  ].sort((a, b) => a[0] - b[0]);
  portrait.shape({ series: [dots("measured", "measured"), dots("simulated", "simulated"), dots("chosen", "chosen", 4)] });
  portrait.show([0, 1, 2, 3].map((column) => all.map((row) => (Number.isFinite(row[column]) ? row[column] : null))));
}
