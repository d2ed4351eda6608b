"""How finely the airliner's lattice is cut."""

from typing import Annotated

from pydantic import Field

from flexsurr.config.schema import Record

Panels = Annotated[int, Field(ge=2)]


class PanelCounts(Record):
    """Strips along each half (or only) span, and panels along the chord: 360 panels in all by default."""

    wing: tuple[Panels, Panels] = (24, 5)
    """Along each half span and along the chord; along the span at least one for each part that sections and
    control surfaces make of it.
    """
    horizontal_tail: tuple[Panels, Panels] = (10, 4)
    """The same."""
    vertical_tail: tuple[Panels, Panels] = (10, 4)
    """Along its only span and along the chord."""
