// What the page asks of its studio. Addresses are relative: the page's own address has the token.

/** An answer that is no answer: what the studio says. */
export class Refused extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

const LOST = "The studio does not answer. If it was ended, start it again on the same folder: nothing that you chose is lost.";

async function ask(path, options) {
  let response;
  try {
    response = await fetch(path, { cache: "no-store", ...options });
  } catch {
    throw new Refused(0, LOST);
  }
  if (!response.ok) {
    throw new Refused(response.status, await response.text());
  }
  return response;
}

/** JSON of a path. */
export async function get(path) {
  return (await ask(path)).json();
}

/** Text of a path. */
export async function text(path) {
  return (await ask(path)).text();
}

/** Sends a value, gets JSON. */
export async function post(path, value) {
  return (await ask(path, { method: "POST", body: JSON.stringify(value) })).json();
}

/** Puts a file into the studio's folder. */
export async function put(file) {
  await ask(`api/records/${encodeURIComponent(file.name)}`, { method: "PUT", body: file });
}

/** Takes a file off the page. */
export async function forget(name) {
  await ask(`api/records/${encodeURIComponent(name)}`, { method: "DELETE" });
}

/** Curves: what their header says, and each column as numbers under its name. */
export async function curves(path, order) {
  const options = order === undefined ? {} : { method: "POST", body: JSON.stringify(order) };
  const bytes = await (await ask(path, options)).arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  const columns = {};
  header.columns.forEach((name, at) => {
    columns[name] = new Float64Array(bytes, 4 + length + 8 * header.rows * at, header.rows);
  });
  return { ...header, columns };
}
