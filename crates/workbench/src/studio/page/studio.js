// The page: what all its parts share, and which part is shown.

import { get, post, Refused } from "./server.js";
import * as records from "./records.js";
import * as rig from "./rig.js";
import * as where from "./where.js";
import * as what from "./what.js";
import * as take from "./take.js";

const PARTS = { records, rig, where, what, take };
const SAVE_AFTER = 400;

/** An element of the page. */
export const at = (id) => document.getElementById(id);

/** A new element with attributes, properties and children. */
export function make(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in node && name !== "list" && name !== "form") {
      node[name] = value;
    } else {
      node.setAttribute(name, value);
    }
  }
  node.append(...children);
  return node;
}

/** A number with the digits that matter. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) {
    return "–";
  }
  return Number(value.toPrecision(digits)).toString().replace("-", "−");
}

/** A name in words. */
export const readable = (name) => name.replaceAll("_", " ");

/** What the parts share. */
export const app = {
  /** What the studio tells. */
  told: null,
  /** What is shown; kept by the studio. */
  view: { tab: "records" },
  /** Numbers set by hand, by model. */
  settings: {},
  /** The record's curves, and the run's. */
  measured: null,
  run: null,

  /** Asks the studio anew, and shows what it tells. */
  async refresh() {
    app.told = await get("api/state");
    at("case").textContent = app.told.name;
    at("folder").textContent = app.told.folder;
    document.title = `${app.told.name}: stickslip studio`;
    for (const part of Object.values(PARTS)) {
      part.refresh(app);
    }
    app.shown();
  },

  /** Lets the part that is seen draw itself. */
  shown() {
    PARTS[app.view.tab].shown(app);
  },

  /** Changes what is shown, and keeps it. */
  look(change) {
    Object.assign(app.view, change);
    app.keep({ view: app.view });
  },

  /** Keeps a choice, after a moment, in which others may come. */
  keep(change) {
    Object.assign(pending, change);
    clearTimeout(timer);
    timer = setTimeout(app.save, SAVE_AFTER);
  },

  /** Keeps at once what waits. */
  async save(more = {}) {
    clearTimeout(timer);
    const change = { ...pending, ...more };
    if (Object.keys(change).length === 0) {
      return;
    }
    try {
      await post("api/state", change);
      pending = {};
    } catch (problem) {
      app.fail(problem);
    }
  },

  /** Does something, and says what went wrong. */
  async attempt(work) {
    try {
      app.quiet();
      return await work();
    } catch (problem) {
      app.fail(problem);
      return undefined;
    }
  },

  /** Says what went wrong. */
  fail(problem) {
    if (!(problem instanceof Refused)) {
      console.error(problem);
    }
    at("alert-text").textContent = problem.message;
    at("alert-anew").hidden = problem.status !== 410;
    at("alert").hidden = false;
  },

  quiet() {
    at("alert").hidden = true;
  },

  /** Goes to a part. */
  go(tab) {
    app.look({ tab });
    select(tab, false);
    scrollTo(0, 0);
  },
};

let pending = {};
let timer;

function select(tab, focus) {
  for (const name of Object.keys(PARTS)) {
    const is = name === tab;
    const button = at(`tab-${name}`);
    button.setAttribute("aria-selected", String(is));
    button.tabIndex = is ? 0 : -1;
    at(`panel-${name}`).hidden = !is;
    if (is && focus) {
      button.focus();
    }
  }
  app.shown();
}

function tabs() {
  const names = Object.keys(PARTS);
  for (const name of names) {
    const button = at(`tab-${name}`);
    button.addEventListener("click", () => app.go(name));
    button.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const end = { Home: 0, End: names.length - 1 }[event.key];
      const place = end ?? (step && (names.indexOf(name) + step + names.length) % names.length);
      if (place !== undefined) {
        event.preventDefault();
        app.look({ tab: names[place] });
        select(names[place], true);
      }
    });
  }
}

async function begin() {
  tabs();
  at("alert-close").addEventListener("click", () => app.quiet());
  at("alert-anew").addEventListener("click", () => app.attempt(() => post("api/state", { ...pending, anew: true })));
  // What waits to be kept is kept, whatever becomes of the page.
  addEventListener("pagehide", () => {
    if (Object.keys(pending).length > 0) {
      fetch("api/state", { method: "POST", body: JSON.stringify(pending), keepalive: true });
    }
  });
  for (const part of Object.values(PARTS)) {
    part.begin(app);
  }
  await app.attempt(async () => {
    const told = await get("api/state");
    Object.assign(app.view, told.choices.view ?? {});
    app.settings = told.choices.settings;
    app.told = told;
    await app.refresh();
  });
  if (!(app.view.tab in PARTS)) {
    app.view.tab = "records";
  }
  select(app.view.tab, false);
  document.body.dataset.ready = "true";
}

begin();
