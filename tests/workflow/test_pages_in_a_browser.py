"""The pages a person looks at, in a real browser: the report, and MLflow's page served on loopback."""

import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from mlflow import MlflowClient
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from flexsurr.config.reading import read_yaml
from flexsurr.config.structure import Structure
from flexsurr.report.catalogue import FIGURES, TABLES
from flexsurr.report.pages import ROWS
from flexsurr.tracking.description import RUN_KEY
from flexsurr.tracking.store import store_uri

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
QUIET = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--window-size=1400,1000",
)
PATIENCE_S = 120
SCROLL_DOWN = "for (const e of document.querySelectorAll('*')) e.scrollTop += 300"
CANTILEVER = Structure(**read_yaml(Path(__file__).parents[2] / "config/structures/cantilever.yaml"))
OF_THE_CANTILEVER = [
    name for name, figure in FIGURES.items() if "trajectories" in figure.sources and figure.shows(CANTILEVER)
]


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium with an empty profile, that keeps what pages print to their console."""
    options = Options()
    options.binary_location = next(filter(None, map(shutil.which, BROWSERS)))
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        for argument in (*QUIET, f"--user-data-dir={profile}"):
            options.add_argument(argument)
        driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
        yield driver
        driver.quit()


def complaints(browser) -> list[str]:
    """Errors of the page's own code, and files it looked for in vain."""
    entries = browser.get_log("browser")
    return [entry["message"] for entry in entries if entry["level"] == "SEVERE"]


def serious(browser) -> list[str]:
    """Complaints, except that MLflow's page asks its server whether it knows users."""
    return [message for message in complaints(browser) if "/users/current" not in message]


def text_of(browser) -> str:
    return browser.find_element(By.TAG_NAME, "body").text


def wait_for(browser, *words: str) -> None:
    """Wait until the page shows all of `words`, whatever their case."""
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: all(word.lower() in text_of(driver).lower() for word in words),
        f"the page does not show {words}",
    )


def click(browser, word: str) -> None:
    """Click the innermost thing that says `word`."""
    found = browser.find_elements(By.XPATH, f"//*[normalize-space(text())='{word}']")
    assert found, f"{word!r} is not on the page: {text_of(browser)}"
    found[-1].click()


def open_report(quick, browser, kind: str, study: str = "cantilever") -> None:
    """The list of a study's figures or tables in the report."""
    browser.get((quick.results / "report.html").as_uri())
    wait_for(browser, "Results")
    open_list(browser, kind, study)


def open_list(browser, kind: str, study: str = "cantilever") -> None:
    """The same, where the report is open already: it has twenty megabytes."""
    click(browser, "Results")
    wait_for(browser, "airliner", "cantilever", "wing")
    click(browser, study)
    wait_for(browser, "figures", "tables")
    click(browser, kind)


def test_the_report_lists_every_figure_and_table_of_the_study(quick, browser):
    figures = {name: FIGURES[name] for name in OF_THE_CANTILEVER}
    for kind, products in (
        ("figures", figures),
        ("tables", {name: TABLES[name] for name in quick.plan.tables("cantilever")}),
    ):
        open_report(quick, browser, kind)
        for name, product in products.items():
            wait_for(browser, name, product.title)
    assert complaints(browser) == []


def test_the_report_shows_each_figure_and_what_to_see_in_it(quick, browser):
    open_report(quick, browser, "figures")
    for name in OF_THE_CANTILEVER:
        wait_for(browser, name)
        look, explain = browser.find_elements(By.XPATH, f"//tr[contains(., '{name}')]//a")
        look.click()
        WebDriverWait(browser, PATIENCE_S).until(
            lambda driver: driver.execute_script(
                "return [...document.images].some(i => i.complete && i.naturalWidth > 100 && i.width > 100)"
            ),
            f"{name}: no picture",
        )
        explain.click()
        caption = " ".join((quick.root / "workflow" / "report" / f"{name}.rst").read_text().split())
        wait_for(browser, caption.replace("*", "").replace("`", "")[:60])
        open_list(browser, "figures")
    assert complaints(browser) == []


@pytest.mark.parametrize(
    ("study", "names"),
    [
        ("wing", ("figure_07", "figure_14", "figure_15", "architecture_errors")),
        ("airliner", (*(f"figure_{number}" for number in range(16, 22)), "coefficient_errors", "trials")),
    ],
)
def test_the_report_lists_the_figures_of_the_other_studies(quick, browser, study, names):
    open_report(quick, browser, "figures", study)
    wait_for(browser, *names)
    assert complaints(browser) == []


@pytest.mark.parametrize(
    ("study", "name"),
    [
        *(("cantilever", name) for name in ("figure_03", "figure_10", "cost_accuracy", "training_loss")),
        ("wing", "figure_14"),
        ("airliner", "figure_16"),
    ],
)
def test_a_browser_draws_the_figures(quick, browser, study, name):
    browser.get((quick.results / "figures" / study / f"{name}.svg").as_uri())
    box = browser.execute_script("const b = document.documentElement.getBBox(); return [b.width, b.height]")
    assert min(box) > 50
    assert complaints(browser) == []


def test_the_report_opens_with_the_answer_and_not_with_the_graph_of_rules(quick, browser):
    browser.get((quick.results / "report.html").as_uri())
    wait_for(browser, "Results", "measured against everything")
    assert browser.find_elements(By.CSS_SELECTOR, "div#rulegraph") == []
    assert "made by" not in text_of(browser).lower()
    (frame,) = browser.find_elements(By.ID, "answer")
    assert frame.size["width"] > 700
    assert frame.size["height"] > 500
    browser.switch_to.frame(frame)
    wait_for(browser, "When does a surrogate pay?", "times_as_fast", "cantilever:", "wing:", "airliner:")
    drawn = (
        "return [...document.images].every(i => i.complete && i.naturalWidth > 100) && document.images.length"
    )
    assert browser.execute_script(drawn) == 1
    table = pd.read_csv(quick.results / "tables" / "answer.csv")
    assert len(browser.find_elements(By.CSS_SELECTOR, "tbody tr")) == len(table)
    wait_for_sorting(browser)
    sort_by(browser, "tip_error_percent")
    assert_sorted(browser, "tip_error_percent")
    browser.switch_to.default_content()
    click(browser, "Workflow")
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: driver.find_elements(By.CSS_SELECTOR, "div#rulegraph")
    )
    assert not browser.find_element(By.ID, "answer").is_displayed()
    assert complaints(browser) == []


def wait_for_sorting(browser) -> None:
    """Wait until the page's table can be sorted, and look for an error that says why it cannot."""
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: driver.find_elements(By.CSS_SELECTOR, "table.dataTable"),
        f"no table that sorts: {complaints(browser)}",
    )


def heads(browser) -> list[str]:
    return [head.text for head in browser.find_elements(By.CSS_SELECTOR, "thead th")]


def sort_by(browser, column: str) -> None:
    names = [name.replace("\n", "") for name in heads(browser)]
    browser.find_elements(By.CSS_SELECTOR, "thead th")[names.index(column)].click()


def column_of(browser, column: str) -> list[str]:
    place = [name.replace("\n", "") for name in heads(browser)].index(column)
    script = (
        f"return [...document.querySelectorAll('tbody tr td:nth-child({place + 1})')].map(td => td.innerText)"
    )
    return browser.execute_script(script)


def assert_sorted(browser, column: str, falling: bool = False) -> None:
    """The numbers of a column rise or fall; those that are missing stand together at one end."""
    numbers = [float(text) if text else -np.inf for text in column_of(browser, column)]
    assert len(set(numbers)) > 2
    assert numbers == sorted(numbers, reverse=falling)


def test_a_table_in_the_report_sorts_by_its_numbers_and_is_searched(quick, browser):
    open_report(quick, browser, "tables")
    wait_for(browser, "cost")
    look, _ = browser.find_elements(By.XPATH, "//tr[td[normalize-space(.)='cost']]//a")
    look.click()
    frame = WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: driver.find_element(By.TAG_NAME, "iframe")
    )
    browser.switch_to.frame(frame)
    wait_for_sorting(browser)
    table = pd.read_csv(quick.results / "tables" / "cantilever" / "cost.csv")
    # written in scientific notation: sorted as words they would be in another order
    shown = column_of(browser, "tip_error_percent")
    assert len(shown) == len(table)
    assert any("e-" in text for text in column_of(browser, "wall_s_mean") + shown)
    for column in ("wall_s_mean", "tip_error_percent"):
        for falling in (False, True):
            sort_by(browser, column)
            assert_sorted(browser, column, falling)
    browser.find_element(By.CSS_SELECTOR, ".dt-search input").send_keys("described")
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: set(column_of(driver, "implementation")) == {"described"}
    )
    assert len(column_of(browser, "implementation")) == (table["implementation"] == "described").sum()
    browser.switch_to.default_content()
    assert complaints(browser) == []


@pytest.mark.parametrize("study", ["cantilever", "wing", "airliner"])
def test_every_table_is_a_page_that_sorts(quick, browser, study):
    for name in quick.plan.tables(study):
        browser.get((quick.results / "tables" / study / f"{name}.html").as_uri())
        wait_for_sorting(browser)
        rows = pd.read_csv(quick.results / "tables" / study / f"{name}.csv")
        assert len(browser.find_elements(By.CSS_SELECTOR, "tbody tr")) == min(max(len(rows), 1), ROWS)
        assert complaints(browser) == []


@dataclass(frozen=True)
class Served:
    """A server's address, the experiment's number there, and the pages of its runs by run_id."""

    address: str
    experiment: str
    pages: dict[str, str]


@pytest.fixture(scope="module")
def served(quick, tmp_path_factory):
    """MLflow's page of the quick preset, on loopback until the tests of this file are done."""
    folder = tmp_path_factory.mktemp("mlflow")
    shutil.copytree(quick.results / "mlflow", folder, dirs_exist_ok=True)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"http://127.0.0.1:{port}"
    client = MlflowClient(store_uri(None, folder))
    experiment = client.get_experiment_by_name("cantilever").experiment_id
    tagged = [(run.data.tags.get(RUN_KEY), run.info.run_id) for run in client.search_runs([experiment])]
    pages = {key: page for key, page in tagged if key}
    command = [sys.executable, "-m", "mlflow", "ui", "--host", "127.0.0.1", "--port", str(port)]
    with (folder / "server.log").open("w") as output:
        server = subprocess.Popen(
            [*command, "--backend-store-uri", store_uri(None, folder), "--workers", "1"],
            cwd=folder,
            env=os.environ | {"MLFLOW_DISABLE_TELEMETRY": "true"},
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        for _ in range(int(PATIENCE_S / 0.2)):
            try:
                urllib.request.urlopen(f"{address}/health", timeout=5).close()
                break
            except (urllib.error.URLError, OSError):
                assert server.poll() is None, (folder / "server.log").read_text()
                time.sleep(0.2)
        yield Served(address, experiment, pages)
    finally:
        os.killpg(server.pid, 15)
        server.wait(PATIENCE_S)


def test_the_address_of_make_ui_opens_on_model_training(served, browser):
    """Not on MLflow's view of language models, which has traces and prompts."""
    makefile = (Path(__file__).parents[2] / "Makefile").read_text()
    place = re.search(r"^MODEL_TRAINING := (.+)$", makefile, re.MULTILINE)[1].replace("\\#", "#")
    browser.get(f"{served.address}/{place}")
    wait_for(browser, "cantilever", "Model registry", "sweeps of cantilever")
    assert "prompts" not in text_of(browser).lower()


def test_the_page_shows_the_sweep_and_its_trials(quick, served, browser):
    runs = quick.plan.studies["cantilever"].runs
    browser.get(f"{served.address}/#/experiments/{served.experiment}/runs")
    # the parent, with its trials folded away below it
    wait_for(browser, "sweeps of cantilever", f"{len(runs) + 1} matching runs")
    assert serious(browser) == []


def test_the_page_of_a_trial_shows_parameters_and_figures(quick, served, browser):
    key, page = next(iter(served.pages.items()))
    browser.get(f"{served.address}/#/experiments/{served.experiment}/runs/{page}")
    wait_for(browser, key, "validation_nmse", "architecture", "dataset_sha256", "sweeps of cantilever")
    assert serious(browser) == []


def test_the_page_of_a_trial_draws_its_losses(served, browser):
    page = next(page for key, page in served.pages.items() if key.startswith("hnn-"))
    browser.get(f"{served.address}/#/experiments/{served.experiment}/runs/{page}/model-metrics")

    def losses_are_drawn(driver) -> bool:
        """At the bottom of the page, which draws what is scrolled to."""
        driver.execute_script(SCROLL_DOWN)
        text, lines = text_of(driver), driver.find_elements(By.CSS_SELECTOR, ".js-plotly-plot path.js-line")
        return "train_loss" in text and "validation_loss" in text and len(lines) >= 2

    WebDriverWait(browser, PATIENCE_S).until(losses_are_drawn, "no curve of the losses")
    assert serious(browser) == []


def test_the_page_of_the_champion_shows_its_alias_and_its_card(served, browser):
    browser.get(f"{served.address}/#/models/cantilever-hamiltonian")
    wait_for(browser, "cantilever-hamiltonian", "champion", "Version 1")
    assert serious(browser) == []
