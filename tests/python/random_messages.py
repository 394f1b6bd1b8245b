"""Random messages, made for our types and for those of lcm-gen's Python code at the same time."""
import numpy as np

LIMITS = {"int8_t": np.int8, "int16_t": np.int16, "int32_t": np.int32, "int64_t": np.int64, "byte": np.uint8}


def random_numbers(rng, kind, shape):
    if kind in LIMITS:
        limits = np.iinfo(LIMITS[kind])
        return rng.integers(limits.min, limits.max, shape, dtype=LIMITS[kind], endpoint=True)
    if kind == "boolean":
        return rng.integers(0, 2, shape).astype(bool)
    return rng.normal(size=shape).astype(np.float32 if kind == "float" else np.float64)


def random_text(rng):
    return "".join(rng.choice(list("abc äß€ 0"), int(rng.integers(0, 9))))


def random_pair(rng, kind, reference_of, most=4):
    """A message of our type `kind`, and the same one of lcm-gen's type. reference_of(name) gives that type."""
    ours, theirs = kind(), reference_of(kind.TYPE.split(".")[1])()
    lengths = {d.text: int(rng.integers(0, most + 1)) for f in kind.FIELDS for d in f.dimensions if not d.fixed}
    for name, length in lengths.items():
        setattr(theirs, name, length)
        setattr(ours, name, -7)  # encode() sets it
    for field in kind.FIELDS:
        if field.name in lengths:
            continue
        shape = tuple(int(d.text) if d.fixed else lengths[d.text] for d in field.dimensions)
        mine, other = random_value(rng, kind, field, shape, reference_of)
        setattr(ours, field.name, mine)
        setattr(theirs, field.name, other)
    return ours, theirs


def random_value(rng, kind, field, shape, reference_of):
    if field.type in LIMITS or field.type in ("boolean", "float", "double"):
        values = random_numbers(rng, field.type, shape)
        if field.type == "byte" and len(shape) == 1:
            return values.tobytes(), values.tobytes()
        return (values, values.tolist()) if shape else (values.item(), values.item())
    if field.type == "string":
        values = [random_text(rng) for _ in range(shape[0] if shape else 1)]
        return (values, list(values)) if shape else (values[0], values[0])
    nested = kind._codec._struct(field.type)
    pairs = [random_pair(rng, nested, reference_of) for _ in range(shape[0] if shape else 1)]
    return ([p[0] for p in pairs], [p[1] for p in pairs]) if shape else pairs[0]
