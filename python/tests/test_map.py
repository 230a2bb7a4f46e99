"""Maps and traces as arrays: copies, parts, coordinates, pictures and datasets."""

import builtins
import copy
import pickle

import numpy as np
import pytest

import flipmap

PI = np.pi


@pytest.fixture(scope="module")
def found():
    return flipmap.render(center=(3.0, 1.25), width=1, size=(8, 4), budget=5)


def copies(of):
    yield "copy", copy.copy(of)
    yield "deepcopy", copy.deepcopy(of)
    yield "method", of.copy()
    yield "numpy", np.copy(of, subok=True)
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        yield f"pickle {protocol}", pickle.loads(pickle.dumps(of, protocol))


def test_copies_and_pickles_of_a_map_keep_everything(found):
    for way, made in copies(found):
        assert type(made) is flipmap.Map and made.tobytes() == found.tobytes(), way
        for name in ("seconds", "units", "engine", "scene", "center", "extent"):
            assert getattr(made, name) == getattr(found, name) is not None, (way, name)
        assert np.array_equal(made.channels, found["time"], equal_nan=True), way
        assert np.array_equal(made.theta1, found.theta1) and not made.uncertain.any(), way
        assert made.flags.writeable, way
    deep = copy.deepcopy(found)
    deep.units["time"] = "h"
    deep["time"][0, 0] = -1
    assert found.units == {"time": "s"} and found["time"][0, 0] != -1


def test_copies_and_pickles_of_a_trace_keep_its_passes():
    traced = flipmap.trace((3, 3), until=4, every=0.5)
    assert traced.passes
    for way, made in copies(traced):
        assert type(made) is flipmap.Trace and np.array_equal(made, traced), way
        assert made.passes == traced.passes and type(made.passes[0]) is flipmap.Pass, way


def test_reductions_are_plain_numbers(found):
    times = found["time"]
    for number in (times.mean(), times.max(), times.sum(), np.median(times), times[0, 0], times.std()):
        assert type(number) is np.float64
    assert type((found["status"] == 1).mean()) is np.float64
    assert type(flipmap.trace((1, 1), until=1, every=0.5)["t"].max()) is np.float64


@pytest.mark.parametrize(
    "part",
    [
        lambda found: found["time"],
        lambda found: found[["time", "trust"]],
        lambda found: found[::-1],
        lambda found: found[:2, 3:],
        lambda found: found[0],
        lambda found: found[found["status"] == 1],
        lambda found: found.T,
        lambda found: found.ravel(),
        lambda found: found.reshape(16, 2),
        lambda found: found.view("u1"),
        lambda found: found == found,
        lambda found: found != found,
        lambda found: np.log(found["time"]),
        lambda found: np.flipud(found),
        lambda found: np.rot90(found, 2),
        lambda found: np.concatenate([found, found]),
        lambda found: np.stack([found, found]),
        lambda found: np.asarray(found),
        lambda found: found.channels,
        lambda found: found.uncertain,
        lambda found: next(iter(found)),
    ],
)
def test_parts_are_plain_arrays(found, part):
    assert type(part(found)) is np.ndarray


def test_a_map_made_otherwise_says_that_it_has_no_scene(found):
    bare = np.asarray(found).view(flipmap.Map)
    for ask in (lambda: bare.extent, lambda: bare.theta1, lambda: bare.channels, bare.plot):
        with pytest.raises(ValueError, match="has no scene"):
            ask()


def test_the_fields_of_a_map_can_be_written(found):
    own = found.copy()
    own["time"][1, 2] = 7
    own[0, 0] = (1, 2, 3, 0.5)
    assert own["time"][1, 2] == 7 and own[0, 0].item() == (1, 2, 3, 0.5)


def test_coordinates_are_those_of_the_pixels_middles(found):
    assert np.allclose(found.theta1, 2.5 + (np.arange(8) + 0.5) / 8, rtol=0, atol=1e-15)
    assert np.allclose(found.theta2, 1.5 - (np.arange(4) + 0.5) / 8, rtol=0, atol=1e-15)
    assert found.theta1.max() > PI, "angles are not wrapped"
    assert list(found.axes) == ["theta1", "theta2"] and found.center == ("3.0", "1.25")
    assert found.from_center["theta1"][0] == -7 / 16 and found.from_center["theta2"][0] == 3 / 16
    assert found.extent == (2.5, 3.5, 1.0, 1.5)
    with pytest.raises(AttributeError, match="no omega1: its axes are theta1 and theta2"):
        found.omega1


def test_a_pixel_is_the_pendulum_at_its_coordinates(found):
    for row, column in [(0, 0), (3, 7), (2, 4)]:
        traced = flipmap.trace((found.theta1[column], found.theta2[row]), until=5, every=1)
        passes = [made.time for made in traced.passes if made.bob == 2]
        assert abs(found["time"][row, column] - (passes or [np.inf])[0]) < 1e-3 or not passes


@pytest.mark.parametrize(
    ("size", "sides"),
    [((8, 8), (2 * PI, 2 * PI)), ((80, 60), (8 * PI / 3, 2 * PI)), ((6, 9), (2 * PI, 3 * PI))],
)
def test_home_is_as_wide_as_its_shape_needs(size, sides):
    home = flipmap.render(size=size, budget=1)
    across, up = np.array(sides) / 2
    # The middle of home is (π, 0): the first rod up, the second one hanging.
    assert np.allclose(home.extent, (PI - across, PI + across, -up, up), rtol=0, atol=1e-12)
    assert np.allclose(home.theta1[[0, -1]], PI + np.array([-1, 1]) * across * (1 - 1 / size[0]))
    assert home.theta2[0] > 0 > home.theta2[-1] and home.shape == size[::-1]


def test_other_planes_have_their_own_axes():
    speeds = flipmap.render(plane="speeds", center=(0, 0), width=8, size=(4, 2), budget=1)
    assert np.array_equal(speeds.omega1, [-3, -1, 1, 3]) and np.array_equal(speeds.omega2, [1, -1])
    section = flipmap.render("section", size=(4, 4), budget=1)
    assert list(section.axes) == ["theta2", "momentum2"] and section.momentum2.shape == (4,)


def test_a_rotated_view_has_coordinates_for_every_pixel():
    turned = flipmap.render(center=(2, 1), width=1, rotate=90, size=(4, 2), budget=1)
    assert turned.theta1.shape == turned.theta2.shape == (2, 4)
    # Rightwards on the picture is upwards in θ2, and downwards is rightwards in θ1.
    assert np.allclose(turned.theta2[0], 1 + np.array([-3, -1, 1, 3]) / 8, rtol=0, atol=1e-15)
    assert np.allclose(turned.theta1[:, 0], 2 + np.array([-1, 1]) / 8, rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match="this one is rotated"):
        turned.extent


def test_deep_coordinates_keep_their_digits_from_the_centre():
    deep = flipmap.render(center=("1.5", "0.5"), width="1e-30", size=2, budget=1)
    assert np.array_equal(deep.from_center["theta1"], [-2.5e-31, 2.5e-31])
    assert deep.center == ("1.5", "0.5")


def plotting():
    matplotlib = pytest.importorskip("matplotlib", reason="Matplotlib is not installed")
    matplotlib.use("Agg")
    import matplotlib.pyplot as pyplot

    return pyplot


def test_a_map_is_drawn_where_it_lies(found):
    pyplot = plotting()
    _, ax = pyplot.subplots()
    drawn = found.plot(ax, cmap="magma_r", vmax=4)
    assert tuple(drawn.get_extent()) == found.extent and drawn.origin == "upper"
    assert drawn.cmap.name == "magma_r" and drawn.get_clim()[1] == 4
    assert ax.get_xlabel() == "theta1, rad" and ax.get_ylabel() == "theta2, rad"
    assert np.array_equal(drawn.get_array().filled(np.inf), found["time"])
    pyplot.close("all")
    assert found.plot(channel="status").axes is pyplot.gca()
    with pytest.raises(ValueError, match="`channel` is 'energy'; the map has time, status, trust"):
        found.plot(channel="energy")
    pyplot.close("all")


def test_rotated_and_deep_maps_are_drawn_too():
    pyplot = plotting()
    turned = flipmap.render(center=(2, 1), width=1, rotate=30, size=(4, 2), budget=1)
    mesh = turned.plot()
    corners = mesh.get_coordinates()
    middles = (corners[1:, 1:] + corners[:-1, :-1]) / 2
    assert np.allclose(middles[..., 0], turned.theta1) and np.allclose(middles[..., 1], turned.theta2)
    pyplot.close("all")
    deep = flipmap.render(center=("1.5", "0.5"), width="1e-30", size=2, budget=1)
    drawn = deep.plot()
    assert np.allclose(np.array(drawn.get_extent()) * 1e30, [-0.5, 0.5, -0.5, 0.5])
    assert drawn.axes.get_xlabel() == "theta1 − 1.5, rad"
    pyplot.close("all")


@pytest.mark.parametrize(
    ("library", "use"), [("matplotlib", lambda of: of.plot()), ("xarray", lambda of: of.to_xarray())]
)
def test_what_is_not_installed_is_named(found, monkeypatch, library, use):
    real = builtins.__import__

    def without(name, *rest):
        if name.split(".")[0] == library:
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=f"pip install {library}"):
        use(found)


def test_a_dataset_has_coordinates_units_and_scene(found):
    pytest.importorskip("xarray", reason="xarray is not installed")
    data = found.to_xarray()
    assert data["time"].dims == ("theta2", "theta1") and data["time"].attrs["units"] == "s"
    assert np.array_equal(data["theta1"], found.theta1) and data["theta1"].attrs["units"] == "rad"
    assert data.attrs["scene"] == found.scene and data["theta2_from_center"].attrs["center"] == "1.25"
    assert data["status"].attrs["flag_meanings"].split()[1] == "flipped"
    nearest = data["time"].sel(theta1=found.theta1[3], theta2=found.theta2[1], method="nearest")
    assert np.array_equal(nearest, found["time"][1, 3], equal_nan=True)
    state = flipmap.render(ask="state", center=(2, 1), width=1, at=1, budget=1, size=(3, 2)).to_xarray()
    assert state["theta1"].dims == ("theta2_at_start", "theta1_at_start")
    turned = flipmap.render(center=(2, 1), width=1, rotate=30, size=(4, 2), budget=1).to_xarray()
    assert turned["time"].dims == turned["theta1"].dims == ("y", "x")
