"""One call: an image in, a mesh out, and what can be done with it."""

from __future__ import annotations

from pathlib import Path

import img2tri

DATA = Path(__file__).parent.parent / "data"


def main(out: str | Path = "out") -> dict[str, float]:
    """Mesh the femur, look at its numbers, and save it."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)

    mesh = img2tri.mesh_image(DATA / "femur.png", edge_length=8, spacing=0.5)  # half a millimetre per pixel; edges of 8 mm

    print(mesh)
    print(mesh.quality())
    print("every promise kept:", mesh.report.kept)

    mesh.save(folder / "femur.ply")
    mesh.save(folder / "femur.vtu")
    mesh.plot(DATA / "femur.png", folder / "femur.png")
    quality = mesh.quality().summary()
    return {
        "triangles": len(mesh.triangles),
        "area": float(mesh.to_trimesh().area),
        "min_angle": quality["min_angle"]["min"],
        "q_mean": quality["q"]["mean"],
        "hausdorff": mesh.report.hausdorff,
    }


if __name__ == "__main__":
    main()
