// Records: which there are, what each is for, and which column is which variable.

import { curves, forget, put } from "./server.js";
import { Plot, holes, phases } from "./charts.js";
import { at, make, number } from "./studio.js";

const ROLES = { learn: "to learn from", hold_out: "held out, to judge on", off: "nothing" };
const VELOCITIES = [
  ["theta_dot", "disc θ̇₂", "measured"],
  ["theta3_dot", "gearbox output θ̇₃", "second"],
  ["theta1_dot", "disc D1 θ̇₁", "simulated"],
];
const ANGLES = [["theta", "disc θ₂", "measured"], ["theta3", "gearbox output θ₃", "second"]];
const INPUTS = [["N2", "N2 [N]", "simulated"], ["N1", "N1 [N]", "measured"], ["u", "u [V]", "second"]];

let plot;
let inputs;
let drawn = "";

export function begin(app) {
  const drop = at("drop");
  at("files").addEventListener("change", (event) => take(app, event.target.files));
  for (const name of ["dragover", "dragleave", "drop"]) {
    addEventListener(name, (event) => {
      event.preventDefault();
      drop.classList.toggle("over", name === "dragover");
    });
  }
  addEventListener("drop", (event) => take(app, event.dataTransfer.files));
  const chosen = (span) => {
    if (span !== null) {
      at("stretch-from").value = span[0].toFixed(3);
      at("stretch-to").value = span[1].toFixed(3);
    }
  };
  plot = new Plot(at("record-plot"), {
    x: "time [s]", y: "velocity [rad/s]", series: [], chosen, name: "Measured velocities over time",
  });
  inputs = new Plot(at("input-plot"), {
    x: "time [s]", y: "force [N]", series: [], chosen, height: 170, name: "Inputs over time",
  });
  at("stretch").addEventListener("submit", (event) => {
    event.preventDefault();
    const span = [Number(at("stretch-from").value), Number(at("stretch-to").value)];
    if (span[0] < span[1]) {
      use(app, app.view.record, { record: app.view.record, span, role: event.submitter.value });
    } else {
      app.fail(new Error(`A stretch begins before it ends; ${span[0]} s is not before ${span[1]} s.`));
    }
  });
  at("stretch-whole").addEventListener("click", () => use(app, app.view.record, null));
  at("columns-apply").addEventListener("click", () => choose(app, mapped()));
  at("columns-forget").addEventListener("click", () => choose(app, {}));
}

/** Takes files that were dropped. */
async function take(app, files) {
  await app.attempt(async () => {
    for (const file of files) {
      if (file.size > app.told.most_upload) {
        throw new Error(`${file.name}: is larger than the ${at("most").textContent} MiB that the studio takes`);
      }
      await put(file);
      if (!file.name.endsWith(".toml")) {
        app.look({ record: file.name.replaceAll(/[^A-Za-z0-9._-]/g, "_") });
      }
    }
    await app.refresh();
  });
  at("files").value = "";
}

/** Keeps what a record, or a stretch of it, is for; `null` makes it whole again. Only one may be held out. */
function use(app, record, added) {
  let uses = app.told.records.flatMap((one) => one.uses);
  if (added === null) {
    uses = uses.filter((one) => one.record !== record);
  } else {
    const overlaps = (one) => one.record === record
      && (!one.span || !added.span || (one.span[0] < added.span[1] && added.span[0] < one.span[1]));
    uses = uses.filter((one) => !overlaps(one));
    if (added.role === "hold_out") {
      uses = uses.map((one) => (one.role === "hold_out" ? { ...one, role: "learn" } : one));
    }
    uses.push(added);
  }
  return app.attempt(async () => {
    await app.save({ uses });
    await app.refresh();
  });
}

function choose(app, columns) {
  return app.attempt(async () => {
    await app.save({ columns });
    drawn = "";
    await app.refresh();
  });
}

/** What the form for columns says. */
function mapped() {
  const columns = {};
  for (const row of at("columns").querySelectorAll("tbody tr")) {
    const [column, unit] = row.querySelectorAll("select");
    if (column.value !== "") {
      columns[row.dataset.variable] = { column: column.value, ...(unit.value === "" ? {} : { unit: unit.value }) };
    }
  }
  return columns;
}

export function refresh(app) {
  at("most").textContent = String(app.told.most_upload / 2 ** 20);
  const { records } = app.told;
  if (!records.some((one) => one.name === app.view.record)) {
    app.view.record = records[0]?.name;
  }
  const body = at("records").tBodies[0];
  body.replaceChildren(...records.flatMap((record) => rows(app, record)));
  if (records.length === 0) {
    body.append(make("tr", {}, make("td", { colSpan: 5, textContent: "No records yet." })));
  }
  columnsForm(app);
}

/** A row for each part of a record. */
function rows(app, record) {
  return record.uses.map((own, place) => {
    const part = own.span ? `${number(own.span[0])} … ${number(own.span[1])} s` : "whole";
    const role = make("select", { "aria-label": `${record.name}, ${part}: for what` });
    for (const [value, text] of Object.entries(ROLES)) {
      role.append(make("option", { value, textContent: text, selected: value === own.role }));
    }
    role.addEventListener("change", () => use(app, record.name, { ...own, role: role.value }));
    const show = make("button", { textContent: record.name, "aria-pressed": String(record.name === app.view.record) });
    show.addEventListener("click", () => {
      app.look({ record: record.name });
      app.refresh();
    });
    const about = make("td");
    if (place === 0) {
      tell(app, record, about);
    }
    const row = make("tr", {},
      make("th", { scope: "row" }, show),
      make("td", { className: "number", textContent: record.rows ? `${record.rows}, every ${number(record.step, 3)} s` : "–" }),
      make("td", { className: "number", textContent: own.span ? part : record.rows ? `${number(record.begin)} … ${number(record.end)} s` : "–" }),
      make("td", {}, role),
      about);
    row.classList.toggle("chosen", record.name === app.view.record);
    return row;
  });
}

function tell(app, record, about) {
  if (record.problem) {
    about.append(make("span", { className: "problem", textContent: record.problem }));
  }
  const holes = record.stretches > 1 ? [`${record.stretches} stretches between holes`] : [];
  const said = [record.said, ...holes, ...(record.notes ?? [])].filter(Boolean);
  about.append(make("span", { className: "hint", textContent: said.join("; ") }));
  if (record.dropped) {
    const button = make("button", { textContent: "Take away", "aria-label": `Take ${record.name} away` });
    button.addEventListener("click", () => app.attempt(async () => {
      await forget(record.name);
      await app.refresh();
    }));
    about.append(" ", button);
  }
}

function columnsForm(app) {
  // A small plant's model file names its columns.
  at("columns").hidden = app.told.models[0]?.kind === "small plant";
  const headings = new Map();
  for (const record of app.told.records) {
    for (const [field, variable] of record.headings) {
      headings.set(field, variable ?? headings.get(field) ?? null);
    }
  }
  const chosen = app.told.choices.columns;
  const rows = app.told.variables.map(({ name, units }) => {
    const guess = [...headings].find(([, variable]) => variable === name)?.[0];
    const column = make("select", { "aria-label": `column of ${name}` });
    column.append(make("option", { value: "", textContent: guess ? `by the header: ${guess}` : "by the header: none" }));
    for (const field of headings.keys()) {
      column.append(make("option", { value: field, textContent: field, selected: chosen[name]?.column === field }));
    }
    const unit = make("select", { "aria-label": `unit of ${name}` });
    unit.append(make("option", { value: "", textContent: `by the header, or ${units[0]}` }));
    for (const own of units) {
      unit.append(make("option", { value: own, textContent: own, selected: chosen[name]?.unit === own }));
    }
    const row = make("tr", {}, make("th", { scope: "row", textContent: name }), make("td", {}, column), make("td", {}, unit));
    row.dataset.variable = name;
    return row;
  });
  at("columns").querySelector("tbody").replaceChildren(...rows);
  at("columns").open ||= app.told.records.some((record) => record.problem && record.headings.length > 0);
}

export function shown(app) {
  draw(app);
}

async function draw(app) {
  const record = app.told?.records.find((one) => one.name === app.view.record);
  const is = record !== undefined && !record.problem;
  at("record-figure").hidden = !is;
  at("stretch").hidden = !is;
  if (!is) {
    return;
  }
  const key = JSON.stringify([record, app.told.choices.columns]);
  if (drawn === key && app.view.tab === "records" && plot.plot) {
    return;
  }
  await app.attempt(async () => {
    const found = await curves(`api/records/${encodeURIComponent(record.name)}`);
    const { columns } = found;
    drawn = key;
    at("record-caption").textContent = `${record.name}${found.every > 1 ? `, every ${found.every}th sample` : ""}.`;
    const there = (list) => list.filter(([name]) => name in columns);
    const velocities = there(VELOCITIES);
    const upper = velocities.length > 0 ? velocities : there(ANGLES);
    plot.shape({
      y: velocities.length > 0 ? "velocity [rad/s]" : "angle [rad]",
      series: upper.map(([, label, colour]) => ({ label, colour })),
    });
    plot.show([columns.time, ...upper.map(([name]) => holes(columns[name]))], phases(columns.time, columns.stuck));
    const lower = there(INPUTS);
    inputs.shape({ series: lower.map(([name, label, colour]) => ({ label, colour, right: name === "u" })) });
    inputs.show([columns.time, ...lower.map(([name]) => holes(columns[name]))]);
  });
}
