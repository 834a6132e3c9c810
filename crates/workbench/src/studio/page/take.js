// Take along: files, and the lines that repeat it.

import { text } from "./server.js";
import { at, make, readable } from "./studio.js";

export function begin(app) {
  for (const name of ["python", "shell"]) {
    at(`copy-${name}`).addEventListener("click", () => app.attempt(async () => {
      await navigator.clipboard.writeText(at(name).textContent);
      at(`copy-${name}`).textContent = "Copied";
    }));
  }
}

function size(bytes) {
  return bytes < 1e5 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

export function refresh(app) {
  const entry = (href, name, what) => make("li", {}, make("a", { href, download: name, textContent: name }), `: ${what}`);
  const results = app.told.files.map((file) => {
    const of = file.hand === null ? "" : ` with ${file.hand.split("+").map(readable).join(" and ")} put in by hand`;
    const path = [...(file.hand === null ? [] : [file.hand]), file.name].map(encodeURIComponent).join("/");
    return entry(`files/${path}`, file.name, `${file.what}${of}, ${size(file.bytes)}`);
  });
  at("downloads").replaceChildren(
    entry("files/model.studio.toml", "model.studio.toml", "the model that is believed, with the columns chosen here"),
    entry("files/repeat.py", "repeat.py", "the lines of Python below"),
    ...results,
  );
}

export function shown(app) {
  if (app.view.tab !== "take") {
    return;
  }
  app.attempt(async () => {
    at("python").textContent = await text("files/repeat.py");
    at("shell").textContent = await text("files/shell.txt");
  });
}
