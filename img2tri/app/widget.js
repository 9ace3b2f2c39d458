"use strict";
// Asks the kernel of a notebook, through the model of the widget; every view has viewer and knobs in a shadow root of its own.

function render({ model, el }) {
  const host = el.appendChild(document.createElement("div")), root = host.attachShadow({ mode: "open" }), waiting = new Map();
  let last = 0;
  root.innerHTML = `<style>${STYLE}</style><div class="img2tri app">${BODY}</div>`;
  const heard = (content, buffers) => {
    const asked = waiting.get(content.id);
    if (!asked) return;
    waiting.delete(content.id);
    if (content.error) { asked.refuse(Object.assign(new Error(content.error), { status: 422 })); return; }
    const view = buffers[0];
    asked.take({ data: view.buffer ? view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength) : view, name: content.name });
  };
  model.on("msg:custom", heard);
  const page = crypto.randomUUID ? crypto.randomUUID() : `${Math.random()}`;  // several views hear each other's answers
  const ask = (kind, { json = null, bytes = null, name = "" } = {}) => new Promise((take, refuse) => {
    const id = `${page} ${++last}`;
    waiting.set(id, { take, refuse });
    model.send({ id, kind, json, name }, undefined, bytes ? [bytes] : []);
  });
  new Knobs(new Page(root), ask).begin();
  return () => { model.off("msg:custom", heard); host.remove(); };
}

export default { render };
