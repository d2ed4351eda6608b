"""Animations: what moves is what was simulated, and a page asks nobody for anything."""

import re
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

from flexsurr.report.animation import ENDINGS, Moving, save_animation

T = np.linspace(0.0, 1.0, 6)
S = np.linspace(0.0, 1.0, 5)


def swinging(phase=0.0, sideways=0.0, times=T):
    z = 0.3 * np.sin(6.0 * times + phase)[:, None] * S**2
    x = np.broadcast_to(S, z.shape)
    return np.stack([x, sideways * z, z], axis=-1)


@pytest.mark.parametrize("sideways", [0.0, 0.5])
def test_every_line_is_where_its_model_is(sideways):
    motions = {
        "reduced order": swinging(0.0, sideways),
        "hnn": swinging(0.1, sideways),
        "mlp": swinging(0.2, sideways),
    }
    moving = Moving(motions, T, "rod")
    assert moving.flat == (sideways == 0.0)
    assert [ax.get_title(loc="left") for ax in moving.figure.axes] == ["HNN", "MLP"]
    assert [name for name, _, _ in moving.lines] == ["reduced order", "hnn", "reduced order", "mlp"]
    for frame in (0, 3, 5):
        moving.show(frame)
        for name, line, trail in moving.lines:
            shown, tip = (
                np.array(each.get_data() if moving.flat else each.get_data_3d()) for each in (line, trail)
            )
            expected = motions[name][frame].T[[0, 2] if moving.flat else [0, 1, 2]]
            np.testing.assert_array_equal(shown, expected)
            np.testing.assert_array_equal(tip[:, -1], expected[:, -1])
            assert tip.shape[1] == frame + 1
        assert moving.clock.get_text() == f"{T[frame]:.3g} s"


def test_a_motion_that_ended_early_stays_where_it_was():
    motions = {"reference": swinging(), "mlp": swinging(times=T[:3])}
    moving = Moving(motions, T, "rod")
    (ax,) = moving.figure.axes
    moving.show(2)
    assert ax.get_title(loc="left") == "MLP"
    moving.show(5)
    np.testing.assert_array_equal(moving.lines[1][1].get_ydata(), motions["mlp"][2, :, 2])
    assert ax.get_title(loc="left") == f"MLP, ended at {T[2]:.3g} s"


@pytest.mark.parametrize("sideways", [0.0, 0.5])
def test_what_is_drawn_over_what_stays_is_the_whole_figure(sideways):
    motions = {"reference": swinging(0.0, sideways), "mlp": swinging(0.1, sideways, times=T[:3])}
    moving = Moving(motions, T, "rod")
    pictures = list(moving.pictures())
    assert len(pictures) == len(T)
    for artist in moving.moving:
        artist.set_animated(False)
    for frame, picture in enumerate(pictures):
        moving.show(frame)
        moving.figure.canvas.draw()
        np.testing.assert_array_equal(picture, np.asarray(moving.figure.canvas.buffer_rgba())[..., :3])


def test_labels_in_space_lie_within_the_picture_and_the_reference_is_named():
    moving = Moving({"rom": swinging(0.0, 0.5), "hnn": swinging(0.1, 0.5)}, T, "rod")
    assert moving.figure.get_suptitle() == "rod  (grey: reduced order)"
    moving.figure.canvas.draw()
    (ax,) = moving.figure.axes
    whole = moving.figure.bbox
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        box = axis.label.get_window_extent()
        assert whole.x0 <= box.x0 < box.x1 <= whole.x1
        assert whole.y0 <= box.y0 < box.y1 <= whole.y1


def test_a_gif_has_a_picture_for_every_time_and_they_differ(tmp_path):
    path = tmp_path / "rod.gif"
    save_animation({"reference": swinging(), "hnn": swinging(0.3)}, T, "rod", path)
    with Image.open(path) as film:
        assert film.format == "GIF"
        assert film.n_frames == len(T)
        pictures = []
        for frame in range(film.n_frames):
            film.seek(frame)
            pictures.append(np.asarray(film.convert("L")))
    assert all((a != b).any() for a, b in pairwise(pictures))
    assert [file.name for file in tmp_path.iterdir()] == ["rod.gif"]


def test_a_page_needs_no_network(tmp_path):
    path = tmp_path / "rod.html"
    save_animation({"reference": swinging()}, T[:2], "rod", path)
    text = path.read_text()
    assert not re.search(r"https?://(?!www\.w3\.org)|<link|fa-", text)
    assert text.count("data:image/png;base64") == 2
    assert "▶" in text


@pytest.mark.parametrize(("name", "motions"), [("rod.mp4", {"reference": swinging()}), ("rod.gif", {})])
def test_what_cannot_be_shown_is_refused(tmp_path, name, motions):
    with pytest.raises(
        ValueError, match="allowed endings" if name not in ENDINGS and motions else "no motion"
    ):
        save_animation(motions, T, "rod", tmp_path / name)
    assert not list(tmp_path.iterdir())
