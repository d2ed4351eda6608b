"""Runs on the MLflow page: the only package that knows MLflow.

Files are the truth and MLflow is a view of them: whatever goes wrong here is a warning in the log, and
the results are made all the same. One experiment a study; in it one parent run for the sweeps of the
study, of which each trial is a child. No result depends on this package, so an edit of it makes nothing anew.
"""

import os

# Before MLflow is imported. It reports its use to its makers otherwise, and waits minutes for a dead server.
os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
os.environ.setdefault("MLFLOW_HTTP_REQUEST_MAX_RETRIES", "1")
os.environ.setdefault("MLFLOW_HTTP_REQUEST_TIMEOUT", "5")
