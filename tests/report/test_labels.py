"""Labels keep clear of each other and of the points."""

import matplotlib
import pytest
from matplotlib.text import Text

from flexsurr.report.labels import freeze_layout, place_labels
from flexsurr.report.style import STYLE, new_figure


@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_no_two_labels_overlap(spread):
    with matplotlib.rc_context(STYLE):
        figure = new_figure(4.0, 3.0)
        ax = figure.subplots()
        points = [(0.5 + spread * 0.1 * i, 0.5 + spread * 0.05 * (i % 3)) for i in range(6)]
        ax.plot(*zip(*points, strict=True), "o")
        ax.set(xlim=(0, 1.6), ylim=(0, 1.2))
        freeze_layout(figure)
        place_labels(ax, points, [f"label {i}" for i in range(6)], ["black"] * 6, points)
        figure.canvas.draw()
        boxes = [Text.get_window_extent(label) for label in ax.texts]
    assert len(boxes) == 6
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])
        assert not any(box.contains(*ax.transData.transform(point)) for point in points)
