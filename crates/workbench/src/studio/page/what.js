// What: the diagnosis, its candidates, its finding, and effects that are put in or taken out by hand.

import { get, post } from "./server.js";
import { at, make, number, readable } from "./studio.js";

const EVERY = 300;
const VERDICTS = {
  nothing_missing: "Nothing is missing",
  parameters: "Other numbers explain the records; no effect is missing",
  named: "Missing",
  ambiguous: "One of several effects is missing",
  not_in_catalogue: "Something is missing that the catalogue does not have",
  located: "Where they disagree was looked at",
};

let watching = null;
let ticked = null;

export function begin(app) {
  at("start").addEventListener("click", () => { ticked = null; });
  for (const [id, wish] of [["start", "start"], ["pause", "pause"], ["continue", "continue"], ["stop", "stop"]]) {
    at(id).addEventListener("click", () => want(app, { do: wish }));
  }
  at("by-hand").addEventListener("click", () => want(app, { do: "by_hand", effects: [...(ticked ?? named(app))] }));
}

async function want(app, wish) {
  await app.attempt(async () => {
    await app.save();
    show(app, await post("api/diagnosis", wish));
    watch(app);
  });
}

/** Looks how far it is, as long as it runs. */
function watch(app) {
  clearTimeout(watching);
  watching = setTimeout(async () => {
    let progress;
    try {
      progress = await get("api/diagnosis");
    } catch (problem) {
      app.fail(problem);
      watching = setTimeout(() => watch(app), 5 * EVERY);
      return;
    }
    show(app, progress);
    if (runs(progress)) {
      watch(app);
    } else {
      await app.attempt(() => app.refresh());
    }
  }, EVERY);
}

const runs = (progress) => ["running", "held", "stopping"].includes(progress.phase);

function show(app, progress) {
  const { phase } = progress;
  app.told.diagnosis = progress;
  const again = ["stopped", "cut off"].includes(phase);
  at("start").disabled = runs(progress);
  at("by-hand").disabled = runs(progress);
  at("start").textContent = again ? "Go on with the diagnosis" : "Start the diagnosis";
  at("pause").hidden = phase !== "running";
  at("continue").hidden = phase !== "held";
  at("stop").hidden = !runs(progress);
  const [short, long] = told(progress);
  // Only what changes with the phase is read aloud.
  if (at("phase").textContent !== short) {
    at("phase").textContent = short;
  }
  at("progress").textContent = long;
  at("progress").className = phase === "failed" ? "problem" : "";
  at("progress").dataset.phase = phase;
  for (const row of at("candidates").tBodies[0].rows) {
    const tries = tried(progress, row.dataset.effect);
    row.querySelector(".tried").textContent = tries === 0 ? "" : tries === 1 ? "once" : `${tries} times`;
    row.classList.toggle("chosen", runs(progress) && (progress.now ?? "").includes(readable(row.dataset.effect)));
  }
}

/** How often an effect was tried, alone or with others. */
function tried(progress, effect) {
  const all = Object.entries(progress.tried ?? {});
  return all.filter(([name]) => name.split(" + ").includes(readable(effect))).reduce((sum, [, count]) => sum + count, 0);
}

function told(progress) {
  const what = progress.by_hand ? `fit by hand (${progress.by_hand.map(readable).join(" + ") || "no effect"})` : "diagnosis";
  const time = `${number(progress.seconds, 3)} s`;
  const kept = progress.finished?.length ? ` Finished and kept: ${progress.finished.join(", ")}.` : "";
  switch (progress.phase) {
    case "running": return [`The ${what} runs.`, `${time}: ${progress.now}.`];
    case "held": return [`The ${what} is held.`, `${time}, at: ${progress.now}.`];
    case "stopping": return [`The ${what} stops at its next step.`, ""];
    case "stopped": return [`The ${what} was stopped.`, `${time}.${kept}`];
    case "done": return [`The ${what} is done.`, `${time}.`];
    case "failed": return [`The ${what} cannot be done.`, progress.text];
    case "cut off": return ["The studio ended in the middle of a diagnosis.", "It goes on behind what is finished."];
    default: return ["No diagnosis was made yet.", ""];
  }
}

/** Effects of the finding. */
function named(app) {
  return new Set((app.told.finding?.effects ?? []).map((effect) => effect.name));
}

export function refresh(app) {
  const { finding } = app.told;
  at("stale").hidden = !finding || app.told.is_of_now;
  at("finding").replaceChildren(...(finding ? found(app, finding, true) : []));
  candidates(app);
  hands(app);
  report(app);
  show(app, app.told.diagnosis);
  if (runs(app.told.diagnosis)) {
    watch(app);
  }
}

function headline(finding) {
  const names = finding.effects.map((effect) => readable(effect.name)).join(" and ");
  switch (finding.verdict) {
    case "named": return names ? `Missing: ${names}` : "The model with refitted numbers";
    case "ambiguous": return `One of these is missing: ${finding.alternatives.map(readable).join("; ")}`;
    default: return VERDICTS[finding.verdict];
  }
}

/** Errors on the held-out record: of a rig through its FMU, of a small plant after each step. */
function errors(finding) {
  const gap = finding.gap?.through_fmu;
  if (gap) {
    return { before: gap.before, after: gap.after, floor: gap.noise_floor, closed: gap.closed, unit: "standard deviations" };
  }
  const steps = finding.small_plant?.steps ?? [];
  if (steps.length === 0) {
    return null;
  }
  const { unit } = finding.small_plant;
  return { before: steps[0].held_out.rmse, after: steps[steps.length - 1].held_out.rmse, floor: null, closed: null, unit };
}

function found(app, finding) {
  const nodes = [make("p", { className: "verdict", textContent: headline(finding) })];
  const tile = (text, value) => make("li", {}, make("b", { textContent: value }), text);
  const tiles = make("ul", { className: "tiles" });
  const error = errors(finding);
  if (error) {
    if (error.closed !== null && error.closed !== undefined) {
      tiles.append(tile("of the gap on the held-out record is closed", `${number(100 * error.closed, 4)} %`));
    }
    tiles.append(tile(`error before, ${error.unit}`, number(error.before, 3)), tile("error after", number(error.after, 3)));
    if (error.floor !== null) {
      tiles.append(tile("what noise alone leaves", number(error.floor, 3)));
    }
  }
  const best = finding.ranking[0];
  const rival = finding.ranking.find((one) => one.margin !== null && one !== best && one.margin > 0);
  if (best && rival) {
    const deviation = rival.margin_error ? ` ± ${number(rival.margin_error, 2)}` : "";
    tiles.append(tile(`in ln likelihood ahead of the nearest rival, ${readable(rival.name)}`, `${number(rival.margin, 3)}${deviation}`));
  } else if (finding.ranking[1]) {
    const margin = best.gain - finding.ranking[1].gain;
    tiles.append(tile(`in ln likelihood ahead of the nearest rival, ${readable(finding.ranking[1].name)}`, number(margin, 3)));
  }
  nodes.push(tiles);
  if (finding.effects.length > 0) {
    nodes.push(numbers("What is missing, with its numbers", finding.effects.flatMap((effect) =>
      Object.values(effect.parameters).map((value) => [readable(effect.name), value.model_parameter, value]))));
  }
  const refitted = Object.entries(finding.parameters);
  if (refitted.length > 0) {
    nodes.push(make("details", {}, make("summary", { textContent: "Refitted numbers of the model" }),
      numbers("Refitted numbers", refitted.map(([name, value]) => ["model", name, value]))));
  }
  if (finding.notes.length > 0) {
    nodes.push(make("details", {}, make("summary", { textContent: `Notes (${finding.notes.length})` }),
      make("ul", {}, ...finding.notes.map((textContent) => make("li", { textContent })))));
  }
  return nodes;
}

function numbers(caption, rows) {
  const table = make("table", {}, make("caption", { textContent: caption }));
  const head = ["of", "number", "value", "95 % interval", "unit"].map((textContent) => make("th", { scope: "col", textContent }));
  table.append(make("thead", {}, make("tr", {}, ...head)));
  const body = make("tbody");
  for (const [of, name, value] of rows) {
    const interval = value.interval95 ? `${number(value.interval95[0])} … ${number(value.interval95[1])}` : "not fitted";
    const cells = [number(value.value), interval, value.unit];
    body.append(make("tr", {}, make("td", { textContent: of }), make("th", { scope: "row", textContent: name }),
      ...cells.map((textContent) => make("td", { className: "number", textContent }))));
  }
  table.append(body);
  return make("div", { className: "wide" }, table);
}

function candidates(app) {
  const { finding, effects, choices } = app.told;
  const is = ticked ?? named(app);
  const ranking = new Map((finding?.ranking ?? []).map((one) => [one.name, one]));
  const isThere = new Set((app.told.models[0]?.effects) ?? []);
  // What acts on disc D1 is nothing for a rig without one.
  const isFull = app.told.models[0]?.kind !== "reduced";
  const rows = effects.filter((effect) => isFull || !effect.name.endsWith("1")).map((effect) => {
    const own = ranking.get(effect.name);
    const box = make("input", { type: "checkbox", checked: is.has(effect.name), disabled: isThere.has(effect.name),
      "aria-label": `${readable(effect.name)} in the model` });
    box.addEventListener("change", () => {
      ticked = new Set(ticked ?? named(app));
      ticked[box.checked ? "add" : "delete"](effect.name);
    });
    const search = make("input", { type: "checkbox", checked: !choices.without.includes(effect.name),
      "aria-label": `search for ${readable(effect.name)}` });
    search.addEventListener("change", () => app.attempt(async () => {
      const without = new Set(app.told.choices.without);
      without[search.checked ? "delete" : "add"](effect.name);
      await app.save({ without: [...without] });
      await app.refresh();
    }));
    const interval = own?.interval95 ? ` (${number(own.interval95[0], 3)} … ${number(own.interval95[1], 3)})` : "";
    const row = make("tr", {},
      make("td", {}, box),
      make("th", { scope: "row", title: `${effect.description}. ${effect.signature}`, textContent: readable(effect.name) }),
      make("td", { className: "number tried" }),
      make("td", { className: "number", textContent: own ? `${number(own.gain, 3)}${interval}` : "" }),
      make("td", { className: "number", textContent: own?.margin != null ? `${number(own.margin, 3)} ± ${number(own.margin_error, 2)}` : "" }),
      make("td", { className: "number", textContent: own?.probability != null ? number(own.probability, 3) : "" }),
      make("td", {}, search));
    row.dataset.effect = effect.name;
    return [own?.gain ?? -Infinity, row];
  });
  rows.sort((a, b) => b[0] - a[0]);
  at("candidates").tBodies[0].replaceChildren(...rows.map(([, row]) => row));
}

function hands(app) {
  const all = app.told.by_hand.filter((one) => one.finding);
  at("hands").hidden = all.length === 0;
  at("hands").tBodies[0].replaceChildren(...all.map(({ name, finding, is_of_now: isOfNow }) => {
    const error = errors(finding);
    const words = name.split("+").map(readable).join(" + ");
    const curves = make("button", { textContent: "Curves", "aria-label": `Curves of ${words}` });
    curves.addEventListener("click", () => {
      const key = `hand:${name}`;
      app.look({ model: app.told.models.some((one) => one.key === key) ? key : "believed" });
      app.refresh();
      app.go("rig");
    });
    const link = make("a", { href: `report/${encodeURIComponent(name)}`, target: "_blank", rel: "noopener", textContent: "report",
      "aria-label": `report of ${words}` });
    return make("tr", {},
      make("th", { scope: "row", textContent: words }),
      make("td", { className: "number", textContent: number(error?.after, 4) }),
      make("td", { className: "number", textContent: number(error?.before, 4) }),
      make("td", { className: "number", textContent: error?.closed != null ? `${number(100 * error.closed, 4)} %` : "–" }),
      make("td", {}, curves, " ", link, isOfNow ? "" : make("span", { className: "warning", textContent: " of earlier choices" })));
  }));
}

function report(app) {
  const isThere = app.told.files.some((file) => file.name === "report.html" && file.hand === null);
  const key = isThere ? JSON.stringify(app.told.finding?.seconds) : "";
  if (at("report").dataset.key === key) {
    return;
  }
  at("report").dataset.key = key;
  at("report").replaceChildren();
  if (isThere) {
    const frame = make("iframe", { src: "report/", title: "The report of the diagnosis", loading: "lazy" });
    frame.setAttribute("sandbox", "allow-scripts");
    const link = make("a", { href: "report/", target: "_blank", rel: "noopener", textContent: "Open the report in a tab of its own" });
    at("report").append(make("h3", { textContent: "The report" }), make("p", {}, link), frame);
  }
}

export function shown() {}
