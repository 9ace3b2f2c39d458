"""From a picture to something to print: a gear, 40 mm wide and 6 mm thick."""

from __future__ import annotations

from pathlib import Path

import img2tri

DATA = Path(__file__).parent.parent / "data"
WIDTH, THICKNESS = 40.0, 6.0


def main(out: str | Path = "out") -> dict[str, float]:
    """Mesh the gear in millimetres, give it a thickness, and save it."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)

    pixels = img2tri.mesh_image(DATA / "gear.png")
    span = float((pixels.vertices.max(axis=0) - pixels.vertices.min(axis=0)).max())
    mesh = img2tri.mesh_image(DATA / "gear.png", spacing=WIDTH / span, edge_length=1.0, corners="keep")

    solid = mesh.to_trimesh(height=THICKNESS)
    print(f"{len(solid.faces)} faces, watertight: {solid.is_watertight}, {solid.volume / 1000:.2f} cm3")
    mesh.save(folder / "gear.stl", height=THICKNESS)
    mesh.save(folder / "gear.3mf", height=THICKNESS)
    return {
        "watertight": float(solid.is_watertight),
        "width": float(solid.extents[:2].max()),
        "height": float(solid.extents[2]),
        "volume_over_area": float(solid.volume / mesh.to_trimesh().area),
    }


if __name__ == "__main__":
    main()
