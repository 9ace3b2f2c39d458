"use strict";
/** The page by itself: all is in it. What the address may say after its #: place=1, fill=angle, theme=dark, image=0. */
async function standalone() {
  const page = new Page(document), { viewer } = page, picture = document.getElementById("picture");
  const mesh = new Mesh(unpack(await inflate(document.getElementById("mesh").textContent)));
  page.put({});
  await viewer.place(mesh.view, picture ? "data:image/png;base64," + picture.textContent : null);
  const addressed = () => {
    const said = new URLSearchParams(location.hash.slice(1)), look = {};
    if (said.get("theme")) document.documentElement.dataset.theme = said.get("theme");
    if (said.get("fill") in FILLS) look.fill = said.get("fill");
    for (const name of Object.keys(LAYERS)) if (said.has(name)) look[name] = said.get(name) !== "0";
    viewer.fit();
    viewer.set(look);
    const spot = mesh.view.places[said.get("place")];
    if (spot) viewer.go(spot.x, spot.y, spot);
  };
  viewer.layers[0].mesh = mesh;
  addressed();
  addEventListener("hashchange", addressed);
}

standalone();
