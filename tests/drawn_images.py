"""Images of all kinds, drawn: gray images and masks that are to be thresholded, and label maps that are not."""

from __future__ import annotations

import io
import zlib

import numpy as np
from PIL import Image, ImageDraw
from scipy import ndimage


def clouds(n, rng, width):
    """Smooth values 0..1, every height equally often."""
    field = ndimage.gaussian_filter(rng.standard_normal((n, n)), width, mode="wrap")
    return field.argsort(axis=None).argsort().reshape(n, n) / (n * n - 1)


def shape(n, rng, kind):
    """A white shape on black, n pixels wide."""
    img = Image.new("L", (n, n), 0)
    draw = ImageDraw.Draw(img)
    a, b, c, d = (float(v) for v in rng.uniform(0.08, 0.32, 4) * n)
    if kind == "disc":
        draw.ellipse([a, b, n - c, n - d], fill=255)
    elif kind == "box":
        draw.rectangle([a, b, n - c, n - d], fill=255)
    elif kind == "polygon":
        draw.polygon([(a, b), (n - c, a), (n - b, n - d), (n / 2, n / 2), (c, n - a)], fill=255)
    elif kind == "lines":
        for k in range(7):
            draw.line([tuple(rng.uniform(0, n, 2)), tuple(rng.uniform(0, n, 2))], fill=255, width=max(1, n * (k + 1) // 90))
    elif kind == "pores":
        return np.where(clouds(n, rng, n / 25) > 0.45, 255, 0).astype(np.uint8)
    else:
        draw.text((n / 12, n / 4), "Rg@8", fill=255, font_size=n / 3)
        draw.fontmode = "1"
    return np.where(np.asarray(img) > 127, 255, 0).astype(np.uint8)


def jpeg(values, quality):
    file = io.BytesIO()
    Image.fromarray(values).save(file, "JPEG", quality=quality)
    return np.asarray(Image.open(file))


def enlarged(values, factor, how):
    """Enlarge an image; with how 0 by repeating its pixels."""
    size = (values.shape[1] * factor, values.shape[0] * factor)
    return np.asarray(Image.fromarray(values).resize(size, how))


def repeated(values, factor):
    return np.kron(values, np.ones((factor, factor), values.dtype))


def gray_images():
    """Yield names and images that are no label maps: masks with soft edges, photographs, scans, shadings."""
    for kind in ("disc", "box", "polygon", "lines", "pores", "text"):
        for seed in range(2):
            rng = np.random.default_rng(seed * 100 + zlib.crc32(kind.encode()) % 97)
            hard = {k: shape(96 * k, rng, kind) for k in (1, 2, 3, 4, 8)}
            name = f"{kind} {seed}"
            for k in (2, 3, 4, 8):
                soft = np.asarray(Image.fromarray(hard[k]).resize((96, 96), Image.Resampling.BOX))
                yield f"{name} anti-aliased {k}", soft
            yield f"{name} anti-aliased, from 40 to 200", (40 + soft * (160 / 255)).astype(np.uint8)
            yield f"{name} anti-aliased, twice as large", repeated(soft, 2)
            yield f"{name} anti-aliased, four times as large", repeated(soft, 4)
            yield f"{name} anti-aliased, in colours", np.stack([soft, soft // 2, 255 - soft], axis=2)
            yield f"{name} anti-aliased, 16 bit", soft.astype(np.uint16) * 257
            yield f"{name} anti-aliased, floats", soft / 255.0
            yield f"{name} blurred", np.rint(ndimage.gaussian_filter(hard[1].astype(float), 1.5)).astype(np.uint8)
            for quality in (30, 60, 85, 95):
                yield f"{name} as JPEG {quality}", jpeg(hard[1], quality)
            for how in (Image.Resampling.BILINEAR, Image.Resampling.BICUBIC, Image.Resampling.LANCZOS):
                yield f"{name} enlarged {how.name}", enlarged(hard[1], 3, how)
            dirty = hard[1].copy()
            dirty[rng.integers(0, 96, 12), rng.integers(0, 96, 12)] = 254
            yield f"{name} with strays of 254", dirty
            shaded = (hard[1] * (0.5 + 0.5 * np.linspace(0, 1, 96))).astype(np.uint8)
            yield f"{name} lit from one side", shaded
    for seed in range(8):
        rng = np.random.default_rng(seed)
        field = clouds(128, rng, 2 + 3 * seed)
        yield f"clouds {seed}", (field * 255).astype(np.uint8)
        yield f"clouds {seed}, 12 bit", (field * 4095).astype(np.uint16)
        yield f"clouds {seed}, floats", field
        yield f"clouds {seed}, whole floats", np.rint(field * 255)
        yield f"clouds {seed}, enlarged", repeated((field * 255).astype(np.uint8), 4)
        photo = np.clip(field * 300 - 20 + rng.normal(0, 6, field.shape), 0, 255).astype(np.uint8)
        yield f"photo {seed}", photo
        yield f"photo {seed}, JPEG", jpeg(photo, 75)
        yield f"photo {seed}, colours", np.stack([photo, np.roll(photo, 3), photo[::-1]], axis=2)
        yield f"photo {seed}, enlarged", repeated(photo, 3)
        yield f"photo {seed}, 16 levels", photo // 16 * 16
        yield f"photo {seed}, much too bright", np.clip(photo.astype(int) * 3 - 100, 0, 255).astype(np.uint8)
        tissue = np.where(field > 0.7, 1200, np.where(field > 0.3, 40, -1000)) + rng.normal(0, 12, field.shape)
        yield f"tissue {seed}", np.clip(np.where(tissue < -500, -1024, tissue), -1024, 3000).astype(np.int16)
        yield (
            f"phases with noise {seed}",
            np.clip(60 + 80 * (field * 3).astype(int) + rng.normal(0, 8, field.shape), 0, 255).astype(np.uint8),
        )
        yield f"phases blurred {seed}", np.rint(ndimage.gaussian_filter(60.0 + 80 * (field * 3).astype(int), 1)).astype(np.uint8)
    ramp = np.linspace(0, 255, 512)
    yield "ramp", np.tile(ramp.astype(np.uint8), (60, 1))
    yield "slanted ramp", ((ramp[:, None] + ramp) / 2).astype(np.uint8)
    yield "round ramp", (np.hypot(*np.indices((256, 256)) - 127.5)).astype(np.uint8)
    yield "distances", np.rint(ndimage.distance_transform_edt(shape(256, np.random.default_rng(5), "pores"))).astype(np.uint8)
    yield "noise", np.random.default_rng(0).integers(0, 256, (64, 64), np.uint8)


def cells(n, k, rng):
    """Cells around k points, numbered from 1 by chance."""
    points = rng.random((k, 2)) * n
    rows, columns = np.indices((n, n))
    return np.hypot(rows[..., None] - points[:, 0], columns[..., None] - points[:, 1]).argmin(axis=2) + 1


def in_rows(labels):
    """Number labels by their first pixels, as most programs do."""
    _, first, number = np.unique(labels, return_index=True, return_inverse=True)
    return first.argsort().argsort()[number].reshape(labels.shape) + 1


def parted(labels, line):
    """Part regions by lines one pixel wide."""
    edge = np.zeros(labels.shape, bool)
    edge[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    edge[1:] |= labels[1:] != labels[:-1]
    return np.where(edge, line, labels)


def label_maps():
    """Yield names and images that are label maps of three labels or more."""
    for k in (3, 5, 12, 40, 90):
        for seed in range(3):
            rng = np.random.default_rng(seed * 10 + k)
            grains = cells(120, k, rng)
            yield f"{k} cells {seed}", grains.astype(np.uint8)
            yield f"{k} cells {seed}, by rows", in_rows(grains).astype(np.uint8)
            yield f"{k} cells {seed}, 16 bit with gaps", (grains * 37 + 1000).astype(np.uint16)
            yield f"{k} cells {seed}, whole floats", grains.astype(np.float32)
            yield f"{k} cells {seed}, spread over 0..255", (grains * (255 // k)).astype(np.uint8)
            yield f"{k} cells {seed}, lines of 0", parted(grains, 0).astype(np.uint8)
            yield f"{k} cells {seed}, lines of 255", parted(grains, 255).astype(np.uint8)
            yield f"{k} cells {seed}, twice as large", repeated(grains.astype(np.uint8), 2)
            yield f"{k} cells {seed}, eight times as large", repeated(cells(32, min(k, 12), rng).astype(np.uint8), 8)
            apart = np.where(ndimage.distance_transform_edt(parted(grains, 0)) > 2, grains, 0)
            yield f"{k} cells {seed}, apart", apart.astype(np.uint8)
            colours = rng.integers(0, 256, (k + 1, 3), np.uint8)
            yield f"{k} cells {seed}, in colours", colours[grains]
            flipped = np.where(rng.random(grains.shape) < 0.004, rng.integers(1, k + 1, grains.shape), grains)
            yield f"{k} cells {seed}, with wrong pixels", flipped.astype(np.uint8)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        field = clouds(128, rng, 4 + 2 * seed)
        for k in (3, 4, 6, 10)[: 3 + (seed > 1)]:  # ten phases of narrow bands are a shading
            phases = (field * k).astype(np.uint8).clip(0, k - 1)
            yield f"{k} phases {seed}", phases
            yield f"{k} phases {seed}, 0 to 255", (phases * (255 // (k - 1))).astype(np.uint8)
            yield f"{k} phases {seed}, four times as large", repeated(phases, 4)
        organs = np.zeros((96, 110), np.uint8)
        for label in (1, 2, 3, 5, 8, 9):
            y, x, a, b = rng.uniform((15, 15, 5, 4), (80, 95, 16, 14))
            rows, columns = np.indices(organs.shape)
            organs[((rows - y) / a) ** 2 + ((columns - x) / b) ** 2 < 1] = label
        yield f"organs {seed}", organs
        yield f"organs {seed}, framed by 255", np.where(ndimage.grey_dilation(organs, 3) != ndimage.grey_erosion(organs, 3), 255, organs)
        yield f"one organ {seed}, framed by 255", parted((organs == 9).astype(np.uint8), 255)
        yield f"organs {seed}, thirty pixels", organs[::3, ::3]
    rings = np.hypot(*np.indices((90, 90)) - 44.5).astype(int) // 9
    yield "rings", rings.astype(np.uint8)
    yield "layers", np.repeat(np.arange(1, 13), 7)[:, None] * np.ones((1, 60), np.uint8)
    yield "quarters", repeated(np.array([[0, 1], [2, 3]], np.uint8), 40)
    yield "stripes two pixels wide", np.repeat(np.arange(30) % 3, 2)[:, None] * np.ones((1, 40), np.uint8)
