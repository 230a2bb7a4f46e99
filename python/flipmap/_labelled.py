"""Maps as datasets of xarray."""


def dataset(of, frame, codes):
    """Return a Dataset with the map's channels, codes, coordinates, units and scene."""
    try:
        import xarray
    except ImportError as error:
        raise ImportError("to_xarray needs xarray: install it with pip install xarray") from error
    fields = {name: (("y", "x"), of[name], {}) for name in of.dtype.names}
    for name, unit in of.units.items():
        fields[name][2]["units"] = unit
    if "error" in fields:
        fields["error"][2]["units"] = "s"
    for name, known in codes.items():
        fields[name][2].update(_meanings(known))
    coordinates, names = {}, {}
    for place, (name, unit) in enumerate(zip(frame["names"], frame["units"])):
        own = names[name] = f"{name}_at_start" if name in fields else name
        dims = (("x",), ("y",))[place] if frame["is_upright"] else ("y", "x")
        coordinates[own] = (dims, of.axes[name], {"units": unit})
        offsets = (dims, of.from_center[name], {"units": unit, "center": frame["center"][place]})
        coordinates[f"{own}_from_center"] = offsets
    notes = {"scene": of.scene, "engine": of.engine, "seconds": of.seconds}
    made = xarray.Dataset(fields, coordinates, notes)
    if frame["is_upright"]:
        made = made.swap_dims(x=names[frame["names"][0]], y=names[frame["names"][1]])
    return made


def _meanings(codes):
    """Return the names of codes as the CF conventions write them."""
    return {
        "flag_values": [code.value for code in codes],
        "flag_meanings": " ".join(code.name.lower() for code in codes),
    }
