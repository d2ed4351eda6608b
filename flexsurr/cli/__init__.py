"""The commands that jobs run: read files, call the library, write files.

Each is `python -m flexsurr.cli.<name> --job <file> …`; `--help` lists its files. A job holds exactly the
values that the command depends on (flexsurr/workflow/plan.py).
"""
