"""The architectures as block diagrams: Figs. 5, 6, 7 and 11 of the study."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexsurr.report.diagram import Point, arrow, block, canvas, connect, neuron, path
from flexsurr.report.style import BLACK, BLUE, COLUMN_IN, GREY, ORANGE, PAGE_IN, PURPLE, VERMILION, styled

PALE_RED, PALE_BLUE, PALE_ORANGE, PALE_GREY = "#FBEADF", "#E1EEF7", "#FDF3DC", "#F3F3F3"
PALE_PURPLE = "#F8EAF2"

HIDDEN_DRAWN = (1.55, 1.15, 0.75, 0.2)
"""Heights [in] of the hidden neurons that are drawn; the dots stand between the last two."""


@styled
def figure_05() -> Figure:
    """The MLP: states in, their time derivatives out, nothing known in between."""
    figure, ax = canvas(COLUMN_IN, 1.9)
    inputs, outputs = ((0.75, 1.2), (0.75, 0.6)), ((2.75, 1.2), (2.75, 0.6))
    hidden = _hidden(ax, 1.75, VERMILION, PALE_RED)
    connect(ax, inputs, hidden, GREY)
    connect(ax, hidden, outputs, GREY)
    for centre, text in zip(inputs, (r"$\eta$", r"$p$"), strict=True):
        neuron(ax, centre, text, BLACK, "white")
    for centre, text in zip(outputs, (r"$\dot\eta$", r"$\dot p$"), strict=True):
        neuron(ax, centre, text, BLACK, "white")
    _column_titles(ax, 1.78, ((0.75, "state"), (1.75, "hidden layer"), (2.75, "field")))
    return figure


@styled
def figure_06() -> Figure:
    """The HNN (loss: eq. 11): one scalar H out, the field by differentiation and the canonical structure."""
    figure, ax = canvas(PAGE_IN * 0.75, 1.9)
    inputs = ((0.55, 1.2), (0.55, 0.6))
    hidden = _hidden(ax, 1.5, BLUE, PALE_BLUE)
    energy = (2.4, 0.9)
    connect(ax, inputs, hidden, GREY)
    connect(ax, hidden, (energy,), GREY)
    for centre, text in zip(inputs, (r"$\eta$", r"$p$"), strict=True):
        neuron(ax, centre, text, BLACK, "white")
    neuron(ax, energy, r"$H$", BLUE, PALE_BLUE, radius=0.16)
    block(ax, (3.3, 0.9), (0.8, 0.62), "gradient\n" + r"$\partial_\eta H,\ \partial_p H$", fill=PALE_GREY)
    arrow(ax, (energy[0] + 0.16, 0.9), (2.9, 0.9))
    outputs = ((4.72, 1.2), (4.72, 0.6))
    texts = (r"$\dot\eta = +\,\partial H/\partial p$", r"$\dot p = -\,\partial H/\partial\eta$")
    for (x, y), text in zip(outputs, texts, strict=True):
        block(ax, (x, y), (1.15, 0.34), text)
        arrow(ax, (3.7, 0.9 + 0.4 * (y - 0.9)), (x - 0.575, y))
    _column_titles(
        ax, 1.78, ((0.55, "state"), (1.5, "hidden layer"), (2.4, "energy"), (4.72, "field (in eq. 11)"))
    )
    return figure


@styled
def figure_07() -> Figure:
    """The D-HNN (loss: eq. 12): two scalars H and D out, the field by differentiation of both."""
    figure, ax = canvas(PAGE_IN * 0.82, 1.9)
    inputs = ((0.55, 1.2), (0.55, 0.6))
    heads = ((1.28, "H", BLUE, PALE_BLUE), (0.5, "D", PURPLE, PALE_PURPLE))
    for centre, text in zip(inputs, (r"$\eta$", r"$p$"), strict=True):
        neuron(ax, centre, text, BLACK, "white")
    outputs = ((5.15, 1.28), (5.15, 0.5))
    for middle, name, line, fill in heads:
        hidden = tuple((1.5, middle + offset) for offset in (0.26, 0.0, -0.26))
        for centre in hidden:
            neuron(ax, centre, r"$\sigma$", line, fill, radius=0.11)
        scalar = (2.3, middle)
        connect(ax, inputs, hidden, GREY)
        connect(ax, hidden, (scalar,), GREY)
        neuron(ax, scalar, f"${name}$", line, fill, radius=0.16)
        arrow(ax, (scalar[0] + 0.16, middle), (2.75, middle))
        text = rf"$\partial_\eta {name},\ \partial_p {name}$"
        block(ax, (3.2, middle), (0.9, 0.4), text, line, PALE_GREY)
        for x, y in outputs:
            arrow(ax, (3.65, middle), (x - 0.72, y + 0.06 * (1 if middle > y else -1)), line)
    texts = (
        r"$\dot\eta = \partial H/\partial p + \partial D/\partial\eta$",
        r"$\dot p = -\,\partial H/\partial\eta + \partial D/\partial p$",
    )
    for centre, text in zip(outputs, texts, strict=True):
        block(ax, centre, (1.44, 0.36), text)
    titles = ((0.55, "state"), (1.5, "hidden layers"), (2.3, "energy"), (5.15, "field (in eq. 12)"))
    _column_titles(ax, 1.78, titles)
    _column_titles(ax, 0.14, ((2.3, "dissipation"),))
    return figure


@styled
def figure_11() -> Figure:
    """The augmented surrogate: a network of the free structure, and the load through the Jacobian."""
    figure, ax = canvas(PAGE_IN, 2.25)
    state, split, join, out = 0.35, 0.85, 5.3, 6.0
    upper, lower = 1.65, 0.6
    ax.text(state, 1.4, r"$(\eta,\,p)$", ha="center", va="center", fontsize=9)
    ax.text(2.7, 2.12, "what was learned", ha="center", va="center", color=BLUE)
    block(
        ax, (2.7, upper), (2.5, 0.5), "surrogate of the free structure\n" + r"$f(\eta, p)$", BLUE, PALE_BLUE
    )
    block(
        ax,
        (2.05, lower),
        (1.45, 0.62),
        "kinematics (eq. 1)\n" + r"$J(\eta) = \partial \mathbf{r}/\partial\eta$",
        ORANGE,
        PALE_ORANGE,
    )
    block(ax, (4.05, lower), (1.45, 0.62), "generalised force\n" + r"$Q = J^{\top}F(t)$", ORANGE, PALE_ORANGE)
    ax.text(2.05, 0.13, "what is known exactly", ha="center", va="center", color="#9A6A00")
    neuron(ax, (join, upper), r"$+$", BLACK, "white", radius=0.14)
    block(ax, (out + 0.5, upper), (0.85, 0.5), "integrator", fill=PALE_GREY)

    ax.plot((0.62, split), (1.4, 1.4), color=BLACK, linewidth=0.8)
    path(ax, ((split, 1.4), (split, upper), (1.45, upper)))
    path(ax, ((split, 1.4), (split, lower), (1.325, lower)))
    arrow(ax, (2.775, lower), (3.325, lower))
    arrow(ax, (3.95, upper), (join - 0.14, upper))
    ax.text(4.55, upper + 0.11, r"$\dot\eta,\ \dot p_{\mathrm{free}}$", ha="center")
    path(ax, ((4.775, lower), (join, lower), (join, upper - 0.14)))
    ax.text(join + 0.07, 1.05, r"$Q$, added to $\dot p$", ha="left", va="center")
    ax.text(4.05, 0.07, r"$F(t)$: load", ha="center", va="center")
    arrow(ax, (4.05, 0.14), (4.05, 0.29))
    arrow(ax, (join + 0.14, upper), (out + 0.075, upper))
    path(ax, ((out + 0.5, upper + 0.25), (out + 0.5, 2.02), (state, 2.02), (state, 1.52)))
    return figure


def _hidden(ax: Axes, x: float, colour: str, fill: str) -> tuple[Point, ...]:
    """The hidden layer at `x`; returns the neurons' centres."""
    centres = tuple((x, y) for y in HIDDEN_DRAWN)
    for centre in centres:
        neuron(ax, centre, r"$\sigma$", colour, fill)
    middle = 0.5 * (HIDDEN_DRAWN[-1] + HIDDEN_DRAWN[-2])
    ax.text(x, middle, "$\\vdots$", ha="center", va="center", color=colour)
    return centres


def _column_titles(ax: Axes, y: float, titles: tuple[tuple[float, str], ...]) -> None:
    for x, text in titles:
        ax.text(x, y, text, ha="center", va="center", color="#555555")
