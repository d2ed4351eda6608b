"""The chosen surrogate of a study as a registered model, by the alias `champion`.

The model's artefacts are the weights as training wrote them, arrays and a JSON header: `flexsurr.served`
reads them, and nothing that is loaded is code.
"""

import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mlflow import MlflowClient
from mlflow.entities import LoggedModelOutput
from mlflow.exceptions import MlflowException

from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.store import Store

if TYPE_CHECKING:
    import pandas as pd
    from mlflow.models.signature import ModelSignature

ALIAS = "champion"
WEIGHTS = "flexsurr.weights"  # holds the digest of the weights that a version has
LOADER = "flexsurr.served"


@dataclass(frozen=True)
class Champion:
    """Which run is the best of what: the registered model's name, the run, and the digest of its weights."""

    name: str
    study: str
    key: str
    weights: str

    @property
    def tags(self) -> dict[str, str]:
        """Of the version that it is."""
        return {RUN_KEY: self.key, WEIGHTS: self.weights, "study": self.study}


@dataclass(frozen=True, eq=False)
class Interface:
    """What goes into a registered model and what comes out: columns, parameters by default, an example."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    defaults: Mapping[str, float]
    example: "pd.DataFrame"
    requirement: str


def is_registered(client: MlflowClient, champion: Champion) -> bool:
    """Whether the alias leads to this champion; it is moved where another version is the champion."""
    versions = client.search_model_versions(f"name = '{champion.name}'")
    ours = [version for version in versions if champion.tags.items() <= version.tags.items()]
    if not ours:
        return False
    newest = max(ours, key=lambda version: int(version.version))
    if ALIAS not in newest.aliases:
        client.set_registered_model_alias(champion.name, ALIAS, newest.version)
        client.update_registered_model(champion.name, newest.description)
    return True


def register(
    client: MlflowClient,
    store: Store,
    champion: Champion,
    weights: Path,
    interface: Interface,
    card: str,
) -> bool:
    """A new version of the registered model, made of the `weights` of its run, and the alias on it.

    Nothing, while the page lacks the run.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # MLflow warns of its own types as they are imported
        import mlflow.pyfunc  # here, for it takes seconds that no training needs
        from mlflow.models import Model

    run = _page_run(client, store.experiments[champion.study], champion.key)
    if run is None:
        return False
    try:
        client.create_registered_model(champion.name, {"study": champion.study}, card)
    except MlflowException:
        client.update_registered_model(champion.name, card)
    logged = client.create_logged_model(
        store.experiments[champion.study], champion.name, source_run_id=run, tags=champion.tags
    )
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what MLflow does with pandas
        mlflow.pyfunc.save_model(
            f"{folder}/model",
            loader_module=LOADER,
            data_path=str(weights),
            mlflow_model=Model(run_id=run, model_id=logged.model_id),
            signature=_signature(interface),
            input_example=interface.example,
            pip_requirements=[interface.requirement],
        )
        client.log_model_artifacts(logged.model_id, f"{folder}/model")
    client.finalize_logged_model(logged.model_id, "READY")
    client.log_outputs(run, [LoggedModelOutput(logged.model_id, 0)])
    version = client.create_model_version(
        champion.name,
        logged.artifact_location,  # by its id, MLflow would look for it in a store of its own choice
        run,
        champion.tags,
        description=card,
        model_id=logged.model_id,
    )
    client.set_registered_model_alias(champion.name, ALIAS, version.version)
    return True


def _page_run(client: MlflowClient, experiment: str, key: str) -> str | None:
    """The page's last run of a key."""
    found = client.search_runs([experiment], f"tags.`{RUN_KEY}` = '{key}'", max_results=1)
    return found[0].info.run_id if found else None


def _signature(interface: Interface) -> "ModelSignature":
    from mlflow.models.signature import ModelSignature
    from mlflow.types.schema import ColSpec, ParamSchema, ParamSpec, Schema

    def columns(names: tuple[str, ...]) -> Any:
        return Schema([ColSpec("double", name) for name in names])

    parameters = [ParamSpec(name, "double", value) for name, value in interface.defaults.items()]
    return ModelSignature(
        columns(interface.inputs), columns(interface.outputs), ParamSchema(parameters) if parameters else None
    )
