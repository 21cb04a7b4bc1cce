// Asks the server. Where it can be reached from other machines it wants the token of the address, behind the #.
const token = () => new URLSearchParams(location.hash.slice(1)).get("token");

// What went wrong, as the server tells it; its `status` is 0 where there is no answer at all.
export class Trouble extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

// The answer as a value; null where nothing is new since the one with this tag.
export async function ask(path, { tag, signal } = {}) {
  const headers = {};
  if (token()) headers.Authorization = `Bearer ${token()}`;
  if (tag?.value) headers["If-None-Match"] = tag.value;
  let response;
  try {
    response = await fetch(path, { headers, signal, cache: "no-store", credentials: "omit", redirect: "error" });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Trouble(0, "no answer");
  }
  if (response.status === 304) return null;
  let value;
  try {
    value = await response.json();
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Trouble(0, "the answer broke off");
  }
  if (!response.ok) throw new Trouble(response.status, value.error);
  if (tag) tag.value = response.headers.get("ETag");
  return value;
}
