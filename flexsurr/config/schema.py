"""What every configuration file is built from: strict, frozen records that reject unknown keys."""

from pydantic import BaseModel, ConfigDict


class Record(BaseModel):
    """A frozen record. Unknown keys are errors; numbers are finite; integers are not silently floats."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
