"use strict";
// Asks the server this page came from, with the token it was given.

{
  const token = JSON.parse(document.getElementById("token").textContent);
  const ask = async (kind, { json = null, bytes = null, name = "" } = {}) => {
    const answer = await fetch(kind + (bytes ? `?name=${encodeURIComponent(name)}` : ""), {
      method: json || bytes ? "POST" : "GET", headers: { "X-Token": token }, body: bytes || (json ? JSON.stringify(json) : undefined),
    }).catch(() => { throw Object.assign(new Error("img2tri has ended: start it again with  img2tri app"), { status: 0 }); });
    if (!answer.ok) {
      const text = await answer.text();
      let words = text;
      try { words = JSON.parse(text).error; } catch { /* not from the library */ }
      throw Object.assign(new Error(words), { status: answer.status });
    }
    return { data: await answer.arrayBuffer(), name: answer.headers.get("X-Name") };
  };
  const knobs = new Knobs(new Page(document), ask, true);
  knobs.begin();
}
