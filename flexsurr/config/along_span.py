"""What varies along a structure's span: a table of properties, and masses fixed to it."""

import csv
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from flexsurr.config.errors import ConfigurationError, nearest
from flexsurr.config.schema import Record

Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Triple = tuple[float, float, float]

_ROUNDING = 1e-6  # of the length, by which a table's ends may miss the span's


class AlongSpan(Record):
    """A table of properties along the span: one value of each at every station.

    A property stands here, or among the structure's own keys, not in both.
    """

    file: str | None = None
    """A CSV file beside the structure's own that holds the table: a column for each key below. None: the
    columns stand here.
    """
    interpolation: Literal["linear", "constant"] = "linear"
    """Between stations. constant: from each station on to the next, so that the values of the last have no
    effect. Two stations at one place are a jump.
    """
    stations_m: tuple[float, ...] = ()
    """The stations: lengths along the axis from the clamp [m], ascending, from 0 to the structure's length.
    """
    mass_per_length_kg_m: tuple[Positive, ...] | None = None
    """Mass per span [kg/m]."""
    bending_stiffness_in_plane_N_m2: tuple[Positive, ...] | None = None
    """EI of in-plane bending [N m²]."""
    bending_stiffness_out_of_plane_N_m2: tuple[Positive, ...] | None = None
    """EI of out-of-plane bending [N m²]."""
    torsional_stiffness_N_m2: tuple[Positive, ...] | None = None
    """GJ [N m²]."""
    axial_stiffness_N: tuple[Positive, ...] | None = None
    """EA [N]."""
    torsional_inertia_per_length_kg_m: tuple[NotNegative, ...] | None = None
    """Mass moment of inertia per span about the axis through the centre of gravity [kg m]."""
    inertia_about_y_per_length_kg_m: tuple[NotNegative, ...] | None = None
    """The part of it about y [kg m]."""
    chord_m: tuple[Positive, ...] | None = None
    """Chord [m]; it only limits the offset of the centre of gravity."""
    centre_of_gravity_offset_m: tuple[float, ...] | None = None
    """Centre of gravity from the elastic axis, positive along y [m]."""
    elastic_axis_offset_m: tuple[float, ...] | None = None
    """Elastic axis from the line that the axis follows, positive along y [m]. None: it is that line."""
    axis_psi_deg: tuple[float, ...] | None = None
    """Direction of the unloaded axis: turned first about z of the clamp [°]; positive turns it to the left.
    20 at both ends is an axis swept by 20°, 0 and 45 an arc of 45°.
    """
    axis_theta_deg: tuple[float, ...] | None = None
    """Then about the turned −y [°]; positive lifts it: dihedral."""
    axis_phi_deg: tuple[float, ...] | None = None
    """Then about the axis itself [°]: pretwist; positive lowers the right side."""

    @model_validator(mode="after")
    def _a_value_at_every_station(self) -> Self:
        if self.file is not None:
            raise ValueError(f"file: {self.file!r} is read with the file of a structure alone")
        if len(self.stations_m) < 2:
            raise ValueError(f"stations_m: {len(self.stations_m)} stations; allowed: 2 or more")
        for before, here in pairwise(self.stations_m):
            if here < before or self.stations_m.count(here) > 2:
                raise ValueError(
                    f"stations_m: {here:g} after {before:g}; allowed: ascending, at a jump twice"
                )
        for key in self.given:
            count = len(getattr(self, key))
            if count != len(self.stations_m):
                raise ValueError(
                    f"{key}: {count} values; allowed: {len(self.stations_m)}, one for each station stations_m"
                )
        return self

    @property
    def given(self) -> tuple[str, ...]:
        """The properties that the table has."""
        return tuple(key for key in COLUMNS if getattr(self, key) is not None)

    @property
    def bends(self) -> bool:
        """Whether the axis it gives is another than the clamp's x, untwisted."""
        return any(any(getattr(self, key) or ()) for key in (*AXIS_KEYS, "elastic_axis_offset_m"))

    def check_covers(self, length_m: float) -> None:
        """ValueError unless the stations go from 0 to `length_m`."""
        ends = self.stations_m[0], self.stations_m[-1]
        if abs(ends[0]) > _ROUNDING * length_m or abs(ends[1] - length_m) > _ROUNDING * length_m:
            raise ValueError(
                f"along_span: stations_m: goes from {ends[0]:g} to {ends[1]:g} m; allowed: "
                f"0 to {length_m:g} m, the whole span"
            )


AXIS_KEYS = ("axis_psi_deg", "axis_theta_deg", "axis_phi_deg")
COLUMNS = tuple(key for key in AlongSpan.model_fields if key not in ("file", "interpolation", "stations_m"))


class FixedMass(Record):
    """A body fixed to the structure, such as an engine: it moves with the element that holds it."""

    name: str = ""
    """What it is."""
    at_m: NotNegative
    """Where it is fixed: the length along the axis from the clamp [m]."""
    mass_kg: Positive
    """Its mass [kg]."""
    offset_m: Triple = (0.0, 0.0, 0.0)
    """Its centre of gravity from the elastic axis there, along the section's x (outwards), y (left) and z
    (up) [m].
    """
    inertia_kg_m2: tuple[NotNegative, NotNegative, NotNegative] = (0.0, 0.0, 0.0)
    """Moments of inertia about its own centre of gravity, about the section's x, y and z [kg m²]."""
    products_of_inertia_kg_m2: Triple = (0.0, 0.0, 0.0)
    """The integrals of x y, x z and y z over its mass, about its own centre of gravity [kg m²]."""

    @model_validator(mode="after")
    def _is_of_matter(self) -> Self:
        xx, yy, zz = self.inertia_kg_m2
        if max(xx, yy, zz) > (xx + yy + zz) - max(xx, yy, zz) + 1e-12 * max(xx, yy, zz):
            raise ValueError(
                f"inertia_kg_m2: {list(self.inertia_kg_m2)} is of no body; allowed: each at most the sum of "
                "the other two"
            )
        return self


def with_table(values: Mapping[str, Any], folder: Path, shown: str) -> dict[str, Any]:
    """The `values` of a structure's file, its table read from the CSV file in `folder` that it names, if any.

    `shown` is what errors call `folder`. Raises ConfigurationError for a file that is missing or no table.
    """
    table = values.get("along_span")
    if not isinstance(table, Mapping) or not isinstance(table.get("file"), str):
        return dict(values)
    name = table["file"]
    columns = _read_csv(folder / name, f"{shown}/{name}" if shown else name)
    twice = sorted(set(columns) & set(table))
    if twice:
        raise ConfigurationError([f"{shown}/{name}: {', '.join(twice)}: given beside the file, too"])
    own = {key: value for key, value in table.items() if key != "file"}
    return {**values, "along_span": {**own, **columns}}


def _read_csv(path: Path, shown: str) -> dict[str, list[float]]:
    """The columns of a table of numbers below a line of names; lines that begin with # are left out."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError([f"{shown}: cannot be read as a CSV file ({error})"]) from None
    rows = [
        (number, [cell.strip() for cell in row])
        for number, row in enumerate(csv.reader(text.splitlines()), start=1)
        if any(cell.strip() for cell in row) and not row[0].startswith("#")
    ]
    if not rows:
        raise ConfigurationError([f"{shown}: is empty; allowed: a line of names, then numbers"])
    names, known = rows[0][1], ("stations_m", *COLUMNS)
    problems = [
        f"{shown}: {name}: unknown column{nearest(name, known)}; allowed: {', '.join(known)}"
        for name in names
        if name not in known
    ]
    problems += [f"{shown}: {name}: is there twice" for name in sorted(set(names)) if names.count(name) > 1]
    columns: dict[str, list[float]] = {name: [] for name in names}
    counts = {len(cells) for _, cells in rows[1:]}
    if len(rows) > 2 and len(counts) == 1 and counts != {len(names)}:
        raise ConfigurationError(
            [*problems, f"{shown}: {len(names)} names above {counts.pop()} columns; allowed: one for each"]
        )
    for number, cells in rows[1:]:
        if len(cells) != len(names):
            problems.append(f"{shown}: line {number}: {len(cells)} values; allowed: {len(names)}")
            continue
        for name, cell in zip(names, cells, strict=True):
            try:
                columns[name].append(float(cell))
            except ValueError:
                problems.append(f"{shown}: line {number}: {name}: {cell!r} is not allowed; allowed: a number")
    if problems:
        raise ConfigurationError(problems)
    return columns
