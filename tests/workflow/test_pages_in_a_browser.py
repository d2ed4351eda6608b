"""The pages a person looks at, in a real browser: the report, and MLflow's page served on loopback."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pictures
import pytest
from pictures import (
    PATIENCE_S,
    click,
    headless,
    heads,
    mlflow_page,
    open_list,
    open_table,
    sort_by,
    text_of,
    wait_for,
    wait_for_sorting,
)
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from flexsurr.config.reading import read_yaml
from flexsurr.config.structure import Structure
from flexsurr.report.catalogue import FIGURES, TABLES
from flexsurr.report.pages import ROWS

TOP = Path(__file__).parents[2]
SCROLL_DOWN = "for (const e of document.querySelectorAll('*')) e.scrollTop += 300"
CANTILEVER = Structure(**read_yaml(TOP / "config/structures/cantilever.yaml"))
OF_THE_CANTILEVER = [
    name for name, figure in FIGURES.items() if "trajectories" in figure.sources and figure.shows(CANTILEVER)
]


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium for the tests of this file."""
    with headless(1400, 1000) as driver:
        yield driver


def complaints(browser) -> list[str]:
    """Errors of the page's own code, and files it looked for in vain."""
    entries = browser.get_log("browser")
    return [entry["message"] for entry in entries if entry["level"] == "SEVERE"]


def serious(browser) -> list[str]:
    """Complaints, except that MLflow's page asks its server whether it knows users."""
    return [message for message in complaints(browser) if "/users/current" not in message]


def open_report(quick, browser, kind: str, study: str = "cantilever") -> None:
    """The list of a study's figures or tables in the report."""
    browser.get((quick.results / "report.html").as_uri())
    wait_for(browser, "Results")
    open_list(browser, kind, study)


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


def column_of(browser, column: str) -> list[str]:
    place = heads(browser).index(column)
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
    open_table(browser, "cost")
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


@pytest.fixture(scope="module")
def served(quick):
    """MLflow's page of the quick preset, on loopback until the tests of this file are done."""
    with mlflow_page(quick.results) as page:
        yield page


def test_the_address_of_make_ui_opens_on_model_training(served, browser):
    """Not on MLflow's view of language models, which has traces and prompts."""
    makefile = (TOP / "Makefile").read_text()
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
    browser.get(f"{served.run('hnn')}/model-metrics")

    def losses_are_drawn(driver) -> bool:
        """At the bottom of the page, which draws what is scrolled to."""
        driver.execute_script(SCROLL_DOWN)
        text, lines = text_of(driver), driver.find_elements(By.CSS_SELECTOR, ".js-plotly-plot path.js-line")
        return "train_loss" in text and "validation_loss" in text and len(lines) >= 2

    WebDriverWait(browser, PATIENCE_S).until(losses_are_drawn, "no curve of the losses")
    assert serious(browser) == []


def test_the_page_of_the_champion_shows_its_alias_and_its_card(served, browser):
    browser.get(f"{served.address}/#/models/cantilever-hamiltonian")
    wait_for(browser, "cantilever-hamiltonian", "champion", "Version 1", "Of all runs")
    assert serious(browser) == []


def test_one_command_makes_every_picture_of_the_documents(quick, tmp_path, capsys):
    """But for that of a study which the quick preset leaves out: the command says so, and goes on."""
    pictures.pictures(quick.results, tmp_path)
    assert "crossover.png: left as it is; there is no" in capsys.readouterr().out
    made = {path.name: path for path in tmp_path.iterdir()}
    assert {*made, "crossover.png"} == pictures.NAMES
    for name, path in made.items():
        if path.suffix == ".png":
            picture = plt.imread(path)
            assert picture.shape[1] >= pictures.WIDTH, name
            assert len(np.unique(picture.reshape(-1, picture.shape[2]), axis=0)) > 50, f"{name} is blank"


def test_results_without_pages_leave_their_pictures_as_they_are(tmp_path, capsys):
    figure = tmp_path / "results" / "figures" / "answer.png"
    figure.parent.mkdir(parents=True)
    drawn = np.zeros((4, 6, 3))
    drawn[1, 2] = 1
    plt.imsave(figure, drawn)
    pictures.pictures(tmp_path / "results", tmp_path)
    assert [path.name for path in tmp_path.glob("*.*")] == ["answer.png"]
    np.testing.assert_array_equal(plt.imread(tmp_path / "answer.png")[..., :3], drawn)
    assert capsys.readouterr().out.count("there is no") == 5
