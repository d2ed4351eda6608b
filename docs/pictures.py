"""Every picture of docs/images from finished results: `make pictures`, or `python docs/pictures.py results`.

Figures are copied. Of the report and of MLflow's page a headless Chromium takes screenshots; the page is
served on loopback meanwhile, from a copy of its database. What the results do not hold is left as it is, with
a line that says so.
"""

import argparse
import io
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mlflow import MlflowClient
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from flexsurr.storage import replacing
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
    "--hide-scrollbars",
)
QUIET_SERVER = {"MLFLOW_DISABLE_TELEMETRY": "true", "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}
"""Of MLflow: it asks nobody, and starts none of the processes in which it would run jobs."""

PATIENCE_S = 120.0
SETTLES_S = 1.5  # what a page moves once it is there: a chart that grows, a table that sorts
WIDTH = 1200  # of a screenshot: its text stays legible at the width of a page
ADD_STYLE = "document.head.appendChild(document.createElement('style')).textContent = arguments[0]"
PLAIN = """
.modebar, [data-assistant-ui] { display: none !important; }
"""  # without what MLflow lays over its page
COLUMNS = (
    "params.`architecture`",
    "params.`hidden`",
    "metrics.`long_response_error_percent_worst`",
    "metrics.`operations`",
)
"""Of the table of runs: what a trial is, its error, and its cost."""

FIGURES = {
    "answer.png": "answer.png",
    "cost_accuracy.png": "cantilever/cost_accuracy.png",
    "crossover.png": "crossover/crossover.png",
    "trials.svg": "wing/trials.svg",
}
"""Pictures that are figures, by their places in results/figures."""


@contextmanager
def headless(width: int = WIDTH, height: int = 900) -> Iterator[webdriver.Chrome]:
    """A headless Chromium with an empty profile, that keeps what pages print to their console."""
    options = Options()
    options.binary_location = next(filter(None, map(shutil.which, BROWSERS)))
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        for argument in (*QUIET, f"--window-size={width},{height}", f"--user-data-dir={profile}"):
            options.add_argument(argument)
        driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
        try:
            yield driver
        finally:
            driver.quit()


@dataclass(frozen=True)
class Served:
    """A server's address, an experiment's number there, and the pages of its runs by run_id."""

    address: str
    experiment: str
    pages: dict[str, str]

    def run(self, architecture: str) -> str:
        """The address of the first run of an architecture."""
        page = next(page for key, page in sorted(self.pages.items()) if key.startswith(f"{architecture}-"))
        return f"{self.address}/#/experiments/{self.experiment}/runs/{page}"


@contextmanager
def mlflow_page(results: Path, study: str = "cantilever") -> Iterator[Served]:
    """MLflow's page of `results` on loopback, from a copy: looking changes nothing."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as copy:
        folder = Path(copy)
        shutil.copytree(results / "mlflow", folder, dirs_exist_ok=True)
        uri = store_uri(None, folder)
        client = MlflowClient(uri)
        experiment = client.get_experiment_by_name(study).experiment_id
        tagged = [(run.data.tags.get(RUN_KEY), run.info.run_id) for run in client.search_runs([experiment])]
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = str(probe.getsockname()[1])
        command = [sys.executable, "-m", "mlflow", "ui", "--host", "127.0.0.1", "--port", port]
        with (folder / "server.log").open("w") as output:
            server = subprocess.Popen(
                [*command, "--backend-store-uri", uri, "--workers", "1"],
                cwd=folder,
                env=os.environ | QUIET_SERVER,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            _wait_until_it_answers(f"http://127.0.0.1:{port}", server, folder / "server.log")
            yield Served(f"http://127.0.0.1:{port}", experiment, {key: page for key, page in tagged if key})
        finally:
            os.killpg(server.pid, signal.SIGTERM)
            server.wait(PATIENCE_S)


def _wait_until_it_answers(address: str, server: subprocess.Popen, log: Path) -> None:
    """Wait for the server. ChildProcessError if it has ended instead, TimeoutError if it says nothing."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        try:
            urllib.request.urlopen(f"{address}/health", timeout=5).close()
            return
        except (urllib.error.URLError, OSError):
            if server.poll() is not None:
                raise ChildProcessError(log.read_text()) from None
            time.sleep(0.2)
    raise TimeoutError(f"{address} does not answer")


def text_of(browser: webdriver.Chrome) -> str:
    """What the page says."""
    return browser.find_element(By.TAG_NAME, "body").text


def wait_for(browser: webdriver.Chrome, *words: str) -> None:
    """Wait until the page shows all of `words`, whatever their case."""
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: all(word.lower() in text_of(driver).lower() for word in words),
        f"the page does not show {words}",
    )


def click(browser: webdriver.Chrome, word: str) -> None:
    """Click the innermost thing that says `word`. LookupError where nothing does."""
    found = browser.find_elements(By.XPATH, f"//*[normalize-space(text())='{word}']")
    if not found:
        raise LookupError(f"{word!r} is not on the page: {text_of(browser)}")
    found[-1].click()


def open_list(browser: webdriver.Chrome, kind: str, study: str = "cantilever") -> None:
    """The list of a study's figures or tables, where the report is open already."""
    click(browser, "Results")
    wait_for(browser, study)
    click(browser, study)
    wait_for(browser, "figures", "tables")
    click(browser, kind)


def open_table(browser: webdriver.Chrome, name: str) -> None:
    """A table of the list that is open; its page is the frame that the browser then looks into."""
    wait_for(browser, name)
    look, _ = browser.find_elements(By.XPATH, f"//tr[td[normalize-space(.)='{name}']]//a")
    look.click()
    frame = WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: driver.find_element(By.TAG_NAME, "iframe"), f"{name} does not open"
    )
    browser.switch_to.frame(frame)
    wait_for_sorting(browser)


def wait_for_sorting(browser: webdriver.Chrome) -> None:
    """Wait until the page's table can be sorted."""
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: driver.find_elements(By.CSS_SELECTOR, "table.dataTable"), "no table that sorts"
    )


def heads(browser: webdriver.Chrome) -> list[str]:
    """The columns of the page's table."""
    found = browser.find_elements(By.CSS_SELECTOR, "thead th")
    return [head.text.replace("\n", "") for head in found]


def sort_by(browser: webdriver.Chrome, column: str) -> None:
    """Click on a column's name."""
    browser.find_elements(By.CSS_SELECTOR, "thead th")[heads(browser).index(column)].click()


def report_opening(browser: webdriver.Chrome, page: str) -> None:
    """The report as it opens: with the answer."""
    browser.get(page)
    wait_for(browser, "Results")
    browser.switch_to.frame(browser.find_element(By.ID, "answer"))
    wait_for_sorting(browser)
    _wait_for_images(browser)
    browser.switch_to.default_content()


def report_table(browser: webdriver.Chrome, page: str) -> None:
    """The cantilever's costs in the report without its list, sorted by the time of a response."""
    browser.get(page)
    wait_for(browser, "Results")
    open_list(browser, "tables")
    open_table(browser, "cost")
    browser.switch_to.default_content()
    browser.find_element(By.CSS_SELECTOR, "nav h1 a").click()
    browser.switch_to.frame(browser.find_element(By.TAG_NAME, "iframe"))
    sort_by(browser, "wall_s_mean")
    browser.execute_script(  # below the button that brings the list back
        "const search = document.querySelector('.dt-search');"
        "search.style.scrollMarginTop = '3em'; search.scrollIntoView()"
    )
    browser.switch_to.default_content()


def tracking_sweep(browser: webdriver.Chrome, served: Served) -> None:
    """The scored trials of a study in MLflow's table of runs, sorted by what they are chosen by."""
    query = "searchFilter=metrics.operations%20%3E%200&orderByAsc=true"
    query += "&orderByKey=metrics.%60long_response_error_percent_worst%60"
    browser.get(f"{served.address}/#/experiments/{served.experiment}/runs?{MODEL_TRAINING}&{query}")
    _wait_for_runs(browser, served)
    browser.execute_script(SHOW_COLUMNS, COLUMNS)
    browser.refresh()
    _wait_for_runs(browser, served)


def _wait_for_runs(browser: webdriver.Chrome, served: Served) -> None:
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: any(key in text_of(driver) for key in served.pages), "no trial in the table of runs"
    )


def tracking_losses(browser: webdriver.Chrome, served: Served) -> None:
    """The losses of one network, epoch by epoch."""
    browser.get(f"{served.run('hnn')}/model-metrics?{MODEL_TRAINING}")
    wait_for(browser, "Model metrics")
    browser.find_element(By.CSS_SELECTOR, "input[placeholder='Search metric charts']").send_keys("n_loss")
    WebDriverWait(browser, PATIENCE_S).until(
        lambda driver: len(driver.find_elements(By.CSS_SELECTOR, ".js-plotly-plot path.js-line")) >= 2,
        "no curves of the two losses",
    )


def tracking_champion(browser: webdriver.Chrome, served: Served) -> None:
    """The registered model of a study: its card, its versions, and the alias."""
    browser.get(f"{served.address}/#/models/cantilever-hamiltonian?{MODEL_TRAINING}")
    wait_for(browser, "Version 1", "champion", "Rows of initial states")


MODEL_TRAINING = "workflowType=machine_learning"
SHOW_COLUMNS = """
for (const key of Object.keys(localStorage).filter(key => key.endsWith('-ReactComponentState'))) {
    const state = JSON.parse(localStorage[key]);
    localStorage[key] = JSON.stringify({...state, selectedColumns: arguments[0]});
}
localStorage['mlflow.assistant.panelOpen_v1'] = 'false';
"""  # MLflow keeps them in the browser

OF_REPORT = {"report_opening.png": (report_opening, 1240), "report_table.png": (report_table, 620)}
OF_TRACKING = {
    "tracking_sweep.png": (tracking_sweep, 560),
    "tracking_losses.png": (tracking_losses, 560),
    "tracking_champion.png": (tracking_champion, 1100),
}
"""Pictures that are screenshots: who opens the page, and how many pixels of it are shown."""


NAMES = {*FIGURES, *OF_REPORT, *OF_TRACKING}
"""Of all pictures."""


def _wait_for_images(browser: webdriver.Chrome) -> None:
    drawn = "return [...document.images].every(image => image.complete && image.naturalWidth > 100)"
    WebDriverWait(browser, PATIENCE_S).until(lambda driver: driver.execute_script(drawn), "no picture")


def _in_few_colours(figure: Path) -> bytes:
    """A figure as it is, in a third of its bytes."""
    content = io.BytesIO()
    Image.open(figure).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        content, "png", optimize=True
    )
    return content.getvalue()


def pictures(results: Path, images: Path) -> None:
    """Make what `results` hold of the pictures in the folder `images`, and say of each what became of it."""
    for name, figure in FIGURES.items():
        path = results / "figures" / figure
        if path.exists():
            _write(images / name, _in_few_colours(path) if path.suffix == ".png" else path.read_bytes())
        else:
            print(f"{name}: left as it is; there is no {path}")
    report, database = results / "report.html", results / "mlflow" / "mlflow.db"
    with headless() as browser:
        if report.exists():
            _photograph(browser, OF_REPORT, report.absolute().as_uri(), images)
        else:
            print(f"{', '.join(OF_REPORT)}: left as they are; there is no {report}")
        if database.exists():
            with mlflow_page(results) as served:
                _photograph(browser, OF_TRACKING, served, images)
        else:
            print(f"{', '.join(OF_TRACKING)}: left as they are; there is no {database}")


def _photograph(
    browser: webdriver.Chrome, shots: dict[str, tuple[Callable[..., None], int]], page: object, images: Path
) -> None:
    """Open each page, and keep what it shows once it has come to rest."""
    for name, (open_page, height) in shots.items():
        frame = browser.execute_script("return outerHeight - innerHeight")
        browser.set_window_size(WIDTH, height + frame)
        open_page(browser, page)
        browser.execute_script(ADD_STYLE, PLAIN)
        time.sleep(SETTLES_S)
        _write(images / name, browser.get_screenshot_as_png())


def _write(path: Path, data: bytes) -> None:
    """Beside its place, and moved there."""
    with replacing(path) as beside:
        beside.write_bytes(data)
    print(f"{path.name}: {len(data) / 1000.0:.0f} kB")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, nargs="?", default=Path("results"), help="of a finished run")
    parser.add_argument("--images", type=Path, default=Path(__file__).parent / "images", metavar="FOLDER")
    given = parser.parse_args()
    pictures(given.results, given.images)
